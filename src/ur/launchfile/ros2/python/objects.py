"""Objects that a Python launch file works with while it is read: names, functions, modules, classes, opened files.

They are compared by identity, as in Python, and printed without their parts, of which there can be any number.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.plan.values.expression_functions import size_of
from ur.launchfile.ros2.model import Made, Unknown
from ur.launchfile.ros2.python.api_class import ApiClass
from ur.launchfile.ros2.substitutions import is_wanted, perform
from ur.source.file import Span

if TYPE_CHECKING:
    import ast

    from ur.launchfile.ros2.context import Context

BASE = "super()"  # the attribute of an object that has what its base in the launch API got


UNCERTAIN = "*"  # the attribute of an object of which nothing is certain


class Frame:
    """The names of a module or of a call, and those around it."""

    __slots__ = ("names_here", "outer")

    def __init__(self, outer: Frame | None = None, names: dict[str, object] | None = None) -> None:
        self.outer = outer
        self.names_here: dict[str, object] = names or {}

    def find(self, name: str) -> object:
        """Return the value of a name. Raises KeyError."""
        frame: Frame | None = self
        while frame is not None:
            if name in frame.names_here:
                return frame.names_here[name]
            frame = frame.outer
        raise KeyError(name)

    def names(self) -> list[str]:
        """Return all names."""
        return [*self.names_here, *(self.outer.names() if self.outer else ())]

    @property
    def module(self) -> Frame:
        """The frame of the module."""
        return self if self.outer is None else self.outer.module


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Function:
    """A function of a file, and what it does when it is called."""

    name: str
    node: ast.FunctionDef | ast.Lambda
    call_function: CallFunction
    frame: Frame
    defaults: tuple[object, ...] = ()
    named_defaults: Mapping[str, object] | None = None

    def run(self, arguments: list[object], keywords: dict[str, object]) -> object:
        """Return the result of a call."""
        return self.call_function(self, arguments, keywords)

    def __call__(self, *arguments: object, **keywords: object) -> object:
        """Return the result of a call by a function of Python, such as `map`."""
        return self.run(list(arguments), keywords)

    def call(self, context: Context, arguments: tuple[object, ...], keywords: Mapping[str, object]) -> object:
        """Return the result of a call by an action."""
        return self.run([ContextObject(context), *arguments], dict(keywords))


CallFunction = Callable[[Function, "list[object]", "dict[str, object]"], object]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StaticFunction:
    """A static method of a class of a file."""

    function: Function


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ClassFunction:
    """A class method of a class of a file."""

    function: Function


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PropertyFunction:
    """A property of a class of a file."""

    function: Function
    setter: Function | None = None


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FieldDefault:
    """The default of a field of a dataclass that is made for each object; `make` is None if there is none."""

    make: Callable[[], object] | None


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class UserClass:
    """A class of a file, with what it inherits from others of the file; `fields` are those of a dataclass.

    `api` is the class of the launch API from which it is derived, `exception` what is raised with it.
    """

    name: str
    members: Mapping[str, object]
    fields: tuple[str, ...] = ()
    api: ApiClass | None = None
    bases: tuple[UserClass, ...] = ()
    exception: type[Exception] | None = None

    def find(self, name: str, span: Span | None) -> object:
        """Return a member; a method takes its object as an argument."""
        found = self.members.get(name, Unknown(f"{self.name}.{name} is not computed while reading", span))
        if isinstance(found, ClassFunction):
            return taking_unknown(partial(found.function, self))
        return found.function if isinstance(found, StaticFunction) else found

    def find_super(self, name: str, function: Function | None) -> object:
        """Return the member that a function of this class, or of one above it, finds by `super()`; None without one."""
        for base in self.bases:
            if any(function in (each, getattr(each, "function", None)) for each in base.members.values()):
                return base.find_super(name, function)
        return next((base.members[name] for base in self.bases if name in base.members), None)

    def make(self, arguments: list[object], keywords: dict[str, object]) -> object:
        """Return an object. One that changes only the arguments of its base in the launch API is one of that base."""
        made = Instance(self, {})
        begin = self.members.get("__init__")
        if isinstance(begin, Function):
            begin.run([made, *arguments], keywords)
        elif self.fields:
            given = {**dict(zip(self.fields, arguments, strict=False)), **keywords}
            missing = [name for name in self.fields if name not in given and name not in self.members]
            if missing or len(arguments) > len(self.fields) or not set(given) <= set(self.fields):
                raise TypeError(f"{self.name}() has the arguments {_join(self.fields)}")
            made.attributes.update(given)
            for name in self.fields:
                default = self.members.get(name)
                if isinstance(default, FieldDefault) and default.make is not None and name not in given:
                    made.attributes[name] = default.make()
            if isinstance(begin := self.members.get("__post_init__"), Function):
                begin.run([made], {})
        return made if {"execute", "perform", "describe"} & set(self.members) else made.attributes.get(BASE, made)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Instance:
    """An object of a class of a file."""

    of: UserClass
    attributes: dict[str, object]

    def find(self, name: str, span: Span | None) -> object:
        """Return an attribute or a method."""
        for known in (UNCERTAIN, name):
            if known in self.attributes:
                return self.attributes[known]
        return self.bound(self.of.members.get(name), self.of.find(name, span))

    def bound(self, member: object, found: object) -> object:
        """Return a member of a class for this object; `found` unless it is a property or method."""
        if isinstance(member, PropertyFunction):
            return member.function.run([self], {})
        return taking_unknown(partial(member, self)) if isinstance(member, Function) else found

    def assign(self, name: str, value: object) -> None:
        """Set an attribute, or a property."""
        known = self.of.members.get(name)
        if isinstance(known, PropertyFunction) and known.setter is not None:
            known.setter.run([self, value], {})
        else:
            self.attributes[name] = value

    def perform(self, context: Context) -> object:
        """Return the text of a substitution of the file's own."""
        found = self.of.members.get("perform")
        if isinstance(found, Function):
            return found.run([self, ContextObject(context)], {})
        return Unknown(f"{self.of.name} has no perform()")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Module:
    """A module with its members; what is not there is Unknown."""

    name: str
    members: Mapping[str, object]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Opened:
    """A file that was opened for reading."""

    path: str
    text: str


@dataclass(slots=True, eq=False, repr=False)
class Written:
    """A file that is open for writing; `keep` gets its path and text."""

    path: str
    keep: Callable[[str, str], None]
    text: str = ""

    def write(self, more: object, *_: object) -> object:
        """Append a text."""
        self.text += more.decode() if isinstance(more, bytes) else str(more)
        self.keep(self.path, self.text)
        return len(self.text)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class EventFunction:
    """A function that an event calls: what is known of the event is nothing."""

    function: Function
    span: Span

    @property
    def name(self) -> str:
        """The name of the function."""
        return self.function.name

    def call(self, context: Context, *_: object) -> object:
        """Return the entities that it starts."""
        given = [Unknown("an event decides", self.span), ContextObject(context)]
        names = self.function.node.args
        return self.function.run(given[: len(names.args)] if names.vararg is None else given, {})


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ContextObject:
    """The launch context, as functions of OpaqueFunction get it."""

    context: Context


def attribute_of(value: object, name: str, span: Span, budget: Budget) -> tuple[bool, object]:
    """Return whether an object is one of those here, and its attribute."""
    if isinstance(value, Module):
        if name in value.members:
            return True, value.members[name]
        return True, Unknown(f"{value.name}.{name} is not computed while reading", span)
    if isinstance(value, ApiClass | Function):
        return True, Unknown(f"'.{name}' of a class or function is not computed while reading", span)
    if isinstance(value, Instance | UserClass):
        return True, value.find(name, span)
    if isinstance(value, ContextObject):
        return True, _attribute_of_context(value.context, name, span)
    if isinstance(value, Made):
        return True, _attribute_of_made(value, name, span)
    if isinstance(value, Opened | Written):
        return True, _attribute_of_file(value, name, span, budget)
    if isinstance(value, PurePosixPath):
        return True, _attribute_of_path(value, name, span)
    if isinstance(value, list) and name in _LIST_CHANGES:
        return True, _changing(value, name, budget)
    if isinstance(value, dict) and name in _DICT_CHANGES:
        return True, _changing(value, name, budget)
    if isinstance(value, Mapping) and not isinstance(value, dict):
        return True, getattr(value, name) if name in (
            "get",
            "items",
            "keys",
            "values",
            "copy",
            "setdefault",
        ) else Unknown(f"'.{name}' is not computed while reading", span)
    return False, None


_LONGEST_PATH = 4096


def _attribute_of_file(value: Opened | Written, name: str, span: Span, budget: Budget) -> object:
    budget.weigh(value.text)
    members: dict[str, object] = {"name": value.path, "close": lambda: None, "flush": lambda: None}
    if isinstance(value, Written):
        members["write"] = value.write
    else:
        members |= {"read": lambda *_: value.text, "readlines": lambda *_: value.text.splitlines(keepends=True)}
    return members.get(name, Unknown(f"'.{name}' of a file is not computed while reading", span))


_SIMPLE = frozenset({"DeclareLaunchArgument", "Node", "SetLaunchConfiguration", "LogInfo"})  # which include no file
_LIST_CHANGES = frozenset({"append", "extend", "insert", "pop", "remove", "reverse", "clear"})
_WHOLE = frozenset({"insert", "pop", "remove", "reverse"})
_DICT_CHANGES = frozenset({"update", "setdefault", "pop", "clear"})


def _changing(value: list[object] | dict[object, object], name: str, budget: Budget) -> Callable[..., object]:
    def call(*arguments: object, **keywords: object) -> object:
        if name in _WHOLE:
            budget.spend(len(value))  # all items are moved or compared
        if name in ("extend", "update") and any(isinstance(each, Unknown) for each in arguments):
            if isinstance(value, list):
                value.extend(arguments)
            return None
        found = getattr(value, name)(*arguments, **keywords)
        size_of(value)
        return found

    call.takes_unknown = True  # type: ignore[attr-defined]
    return call


def _attribute_of_made(made: Made, name: str, span: Span) -> object:
    if name == "perform":
        return taking_unknown(lambda context: _perform(made, context, span))
    if name in ("evaluate", "_predicate_func"):
        return taking_unknown(lambda context: _evaluate(made, context, span))
    if made.kind == "LaunchDescription":
        entities: Any = made.values.setdefault("initial_entities", [])
        if name in ("add_action", "add_entity"):
            return taking_unknown(lambda action: entities.append(action))
        if name == "entities":
            return entities
        if name == "get_launch_arguments" and {each.kind for each in entities if isinstance(each, Made)} <= _SIMPLE:
            return lambda *_: [each for each in entities if getattr(each, "kind", "") == "DeclareLaunchArgument"]
    if made.kind == "Command" and name not in made.values:
        return Unknown("the output of xacro is known when it runs", made.span, "command")
    return made.values.get(name, Unknown(f"'.{name}' of {made.kind} is not computed while reading", span))


def _perform(made: Made, context: object, span: Span) -> object:
    if not isinstance(context, ContextObject):
        return Unknown("the launch context is not known here", span)
    return perform(made, context.context)


def _evaluate(made: Made, context: object, span: Span) -> object:
    if not isinstance(context, ContextObject):
        return Unknown("the launch context is not known here", span)
    return is_wanted(made, context.context)


def _attribute_of_context(context: Context, name: str, span: Span) -> object:
    members: dict[str, object] = {
        "launch_configurations": context.configurations,
        "environment": context.environment,
        "perform_substitution": taking_unknown(lambda value: perform(value, context)),
    }
    return members.get(name, Unknown(f"'.{name}' of the launch context is not computed while reading", span))


def taking_unknown(function: Callable[..., object]) -> Callable[..., object]:
    """Return a function that is called with values that are not known, too."""

    def call(*arguments: object, **keywords: object) -> object:
        return function(*arguments, **keywords)

    call.takes_unknown = True  # type: ignore[attr-defined]
    return call


def _attribute_of_path(path: PurePosixPath, name: str, span: Span) -> object:
    if name in ("name", "stem", "suffix", "parent", "parts"):
        return getattr(path, name)
    if name in ("as_posix", "__str__"):
        return lambda: str(path)
    if name in ("joinpath", "with_suffix", "with_name"):
        return lambda *parts: make_path(getattr(path, name)(*map(str, parts)))
    if name in ("resolve", "absolute", "expanduser"):
        return lambda *_: path
    if name == "parents":
        return list(path.parents)
    return Unknown(f"'.{name}' of a path is not computed while reading", span)


def make_path(*parts: object) -> PurePosixPath:
    """Return a path. Raises ValueError for one that is longer than the system's."""
    texts = list(map(str, parts))
    if (length := sum(map(len, texts))) > _LONGEST_PATH:
        raise ValueError(f"a path of {length:,} characters, expected at most {_LONGEST_PATH:,}")
    return PurePosixPath(*texts)


def bind(function: Function, arguments: list[object], keywords: dict[str, object]) -> dict[str, object]:
    """Return the names of a call. Raises TypeError, as Python does."""
    given = function.node.args
    names = [each.arg for each in (*given.posonlyargs, *given.args)]
    bound: dict[str, object] = dict(zip(names, arguments, strict=False))
    extra = arguments[len(names) :]
    if extra and given.vararg is None:
        raise TypeError(f"{function.name}() has {len(arguments)} arguments, expected at most {len(names)}")
    if given.vararg is not None:
        bound[given.vararg.arg] = tuple(extra)
    left = {}
    for name, value in keywords.items():
        if name in names or name in {each.arg for each in given.kwonlyargs}:
            bound[name] = value
        else:
            left[name] = value
    if left and given.kwarg is None:
        raise TypeError(f"{function.name}() has no argument {_join(left)}")
    if given.kwarg is not None:
        bound[given.kwarg.arg] = left
    for name, value in zip(reversed(names), reversed(function.defaults), strict=False):
        bound.setdefault(name, value)
    for name, value in (function.named_defaults or {}).items():
        bound.setdefault(name, value)
    missing = [name for name in (*names, *(each.arg for each in given.kwonlyargs)) if name not in bound]
    if missing:
        raise TypeError(f"{function.name}() needs {_join(missing)}")
    return bound


def _join(names: Iterable[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
