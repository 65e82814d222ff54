"""Data classes that write their methods when these are first called: `dataclasses` takes a third of a command's start.

They have slots, and no `__post_init__`. Functions of `dataclasses` accept them, such as `asdict` and `fields`.
"""

from operator import attrgetter
from typing import TYPE_CHECKING

__all__ = ["dataclass", "field", "replace"]

if TYPE_CHECKING:
    from dataclasses import dataclass, field, replace
else:

    class field(dict):  # noqa: N801 - named as in dataclasses
        """The arguments of `dataclasses.field`."""

    def replace(value, /, **changes):
        """Return a copy with changes."""
        return type(value)(**{name: getattr(value, name) for name in value.__match_args__} | changes)

    def dataclass(*, slots, frozen=False, eq=True, repr=True):
        """Make a data class."""
        assert slots
        return lambda cls: _make_class(cls, frozen, eq, repr)

    def _make_class(cls, frozen, eq, shown):
        space = {name: each for name, each in vars(cls).items() if name not in ("__dict__", "__weakref__")}
        old = {name: each for base in cls.__mro__[:0:-1] for name, each in vars(base).get("__fields__", {}).items()}
        fields = dict(old)
        for name, kind in cls.__annotations__.items():
            if "ClassVar" not in str(kind):
                each = space.pop(name) if name in space else field()
                fields[name] = each if isinstance(each, field) else field(default=each)
        known = {"default", "default_factory", "compare", "repr"}
        assert all(each.keys() <= known and each.get("default").__hash__ for each in fields.values())
        assert "__post_init__" not in space
        names = [name for name, each in fields.items() if each.get("compare", True)] or ["__class__"]
        space |= {
            "__slots__": tuple(name for name in fields if name not in old),
            "__qualname__": cls.__qualname__,
            "__fields__": fields,
            "__match_args__": tuple(fields),
            "__dataclass_fields__": _Standard("__dataclass_fields__"),
            "__dataclass_params__": _Standard("__dataclass_params__"),
            "__compared__": attrgetter(*names, names[0]),  # a tuple in any case
        }
        if shown:
            space.setdefault("__repr__", _represent)
        if eq:
            space.setdefault("__eq__", _equal)
            if space.get("__hash__") is None:
                space["__hash__"] = _hash if frozen else None
        if frozen:
            space |= {"__setattr__": _refuse, "__delattr__": _refuse, "__reduce__": _reduce}

        def begin(self, *values, **named):
            made.__init__ = _write_init(made)
            made.__init__(self, *values, **named)

        made = type(cls)(cls.__name__, cls.__bases__, {"__init__": begin, **space})
        return made

    def _write_init(cls):
        space, arguments, lines = {}, [], []
        for name, each in cls.__fields__.items():
            space[f"_0{name}"] = getattr(cls, name).__set__
            space[f"__{name}"] = each.get("default", each.get("default_factory"))
            arguments.append(f"{name}=__{name}" if each.keys() & {"default", "default_factory"} else name)
            made = f"__{name}() if {name} is __{name} else {name}" if "default_factory" in each else name
            lines.append(f"_0{name}(self, {made})")
        exec(f"def __init__(self, {', '.join(arguments)}):\n " + "\n ".join(lines or ["pass"]), space)  # noqa: S102 - as there
        return space["__init__"]

    def _represent(self):
        names = (name for name, each in self.__fields__.items() if each.get("repr", True))
        return f"{type(self).__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

    def _equal(self, other):
        return self.__compared__(self) == self.__compared__(other) if type(other) is type(self) else NotImplemented

    def _hash(self):
        return hash(self.__compared__(self))

    def _refuse(_self, name, *_):
        from dataclasses import FrozenInstanceError

        raise FrozenInstanceError(f"cannot change field {name!r}")

    def _reduce(self):
        return type(self), tuple(getattr(self, name) for name in self.__fields__)

    class _Standard(str):
        """The description that functions of `dataclasses` look for, of a class that it has made of the same fields."""

        def __get__(self, value, cls):
            import dataclasses

            space = {name: dataclasses.field(**each) for name, each in cls.__fields__.items()}
            space["__annotations__"] = dict.fromkeys(space, object)
            make = dataclasses.dataclass(frozen=cls.__setattr__ is _refuse)
            setattr(cls, self, getattr(make(type(cls.__name__, (), space)), self))
            return getattr(cls, self)
