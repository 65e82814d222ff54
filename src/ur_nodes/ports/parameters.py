"""Parameters of a node, typed, with errors that name the parameter and what was expected."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from math import inf
from typing import NoReturn, Protocol, TypeGuard, TypeVar

from ur.source.diagnostic import UserError, user_error
from ur.source.foreign.yaml_text import load_yaml
from ur.source.suggest import did_you_mean

Limits = tuple[float, float]
Value = TypeVar("Value")

READ_ONLY = "read at the start only"

_REQUIRED: object = object()
_ABSENT: object = object()
_ANY = (-inf, inf)
_MOST = 2**31 - 1  # of an integer in a message


class ParameterStore(Protocol):
    """A backend's store of parameters; names are as for `Node.resolve`."""

    def resolve(self, name: str) -> str:
        """Return the full name, for messages."""

    def has(self, name: str) -> bool:
        """Return True when the parameter is set."""

    def get(self, name: str) -> object:
        """Return the value: a bool, int, float, str, list or dict. Raises KeyError."""

    def set(self, name: str, value: object) -> None:
        """Set the parameter."""


@dataclass(frozen=True, slots=True)
class Declaration:
    """A parameter that a node has read: the `value` in use, what is expected, and the limits of a number.

    `live` describes one that may be set while the node runs, with its unit; it is '' for one that may not.
    """

    value: object
    expected: str
    limits: Limits
    live: str


@dataclass(slots=True)
class _Reads:
    """The reads of a node, by full names: the values `given` by the user, and the readers that follow changes."""

    given: dict[str, object] = field(default_factory=dict)
    declared: dict[str, Declaration] = field(default_factory=dict)
    readers: list[Callable[[Parameters], Callable[[], None]]] = field(default_factory=list)
    again: bool = False  # these are read again: earlier values count, not those of the store


class Parameters:
    """Reads parameters below `namespace` ('~' is the node itself). Raises UserError."""

    def __init__(self, store: ParameterStore, namespace: str = "~", reads: _Reads | None = None) -> None:
        self._store = store
        self._namespace = namespace
        self._reads = reads or _Reads()

    def below(self, name: str) -> Parameters:
        """Return the parameters of a sub-namespace."""
        return Parameters(self._store, f"{self._namespace}{name}/", self._reads)

    def of(self, node: str) -> Parameters:
        """Return the parameters of another node, by its name."""
        return Parameters(self._store, f"{node}/")

    def follow(self, read: Callable[[Parameters], Value], apply: Callable[[Value], None]) -> Value:
        """Read settings now, and again whenever a `live` parameter is changed; `apply` gets them then."""
        self._reads.readers.append(lambda again: partial(apply, read(again)))
        return read(self)

    def change(self, values: Mapping[str, object]) -> str:
        """Apply what a user sets while the node runs, all of it or nothing. Return '' or the reason of a refusal.

        Names are as for `ParameterStore`. To be called on the node's thread.
        """
        reads, changed = self._reads, {self._store.resolve(name): value for name, value in values.items()}
        fresh = _Reads({**reads.given, **changed}, dict(reads.declared), again=True)
        for name in changed:
            if name not in reads.declared:
                return f"parameter {name} is not one that the node reads"
            if not reads.declared[name].live:
                return f"parameter {name} is {READ_ONLY}; set it in the launch file"
        try:
            calls = [read(Parameters(self._store, self._namespace, fresh)) for read in reads.readers]
        except UserError as problem:
            return str(problem)
        reads.given, reads.declared = fresh.given, fresh.declared
        for call in calls:
            call()
        return ""

    def declared(self) -> Mapping[str, Declaration]:
        """Return the parameters that the node has read so far, by their full names; for any thread."""
        return dict(self._reads.declared)

    def has(self, name: str) -> bool:
        """Return True when the parameter is set."""
        return self._store.has(self._namespace + name)

    def any(self, name: str, default: object = None) -> object:
        """Return the unchecked value; `default` if it is not set."""
        return self._declare(name, self._get(name, default, ""), "any value")

    def keep(self, name: str, value: object) -> None:
        """Set a parameter, which the node reads when it is restarted."""
        self._store.set(self._namespace + name, value)
        self._reads.given[self.name(name)] = value

    def keep_all(self, values: Mapping[str, object]) -> None:
        """Set parameters, unless the store has ended."""
        with contextlib.suppress(OSError):
            for name, value in values.items():
                self.keep(name, value)

    def name(self, name: str) -> str:
        """Return the full name of a parameter, for messages."""
        return self._store.resolve(self._namespace + name)

    def number(
        self, name: str, default: object = _REQUIRED, *, minimum: float = -inf, maximum: float = inf, live: str = ""
    ) -> float:
        """Return a finite number within limits (inclusive). For `live` see `Declaration`."""
        limits = (minimum, maximum)
        expected = "a number" if limits == _ANY else f"a number from {minimum:g} to {maximum:g}"
        value = self._get(name, default, "a number")
        if not _is_number(value) or not minimum <= value <= maximum:
            self.fail(name, value, expected)
        return self._declare(name, float(value), expected, limits, live)

    def limit(self, name: str, default: object = _REQUIRED, *, minimum: float, live: str) -> float:
        """Return a limit of the base, a number that cannot be raised above its first value while the node runs."""
        if self._reads.again:
            maximum = self._reads.declared[self.name(name)].limits[1]
            return self.number(name, default, minimum=minimum, maximum=maximum, live=live)
        value = self.number(name, default, minimum=minimum)
        return self._declare(name, value, f"a number from {minimum:g} to {value:g}", (minimum, value), live)

    def integer(self, name: str, default: object = _REQUIRED, *, minimum: int | None = None, live: str = "") -> int:
        """Return an integer of at least `minimum`. For `live` see `Declaration`."""
        expected = "a whole number" + ("" if minimum is None else f" of at least {minimum}")
        value = self._get(name, default, "a whole number")
        if not isinstance(value, int) or isinstance(value, bool) or (minimum is not None and value < minimum):
            self.fail(name, value, expected)
        return self._declare(name, int(value), expected, (-_MOST if minimum is None else minimum, _MOST), live)

    def text(self, name: str, default: object = _REQUIRED, *, choices: Iterable[str] = ()) -> str:
        """Return a string; with `choices`, one of them."""
        allowed = list(choices)
        expected = f"one of {', '.join(allowed)}" if allowed else "a text"
        value = self._get(name, default, "a text")
        if not isinstance(value, str) or (allowed and value not in allowed):
            self.fail(name, value, expected, allowed)
        return self._declare(name, str(value), expected)

    def boolean(self, name: str, default: object = _REQUIRED, *, live: str = "") -> bool:
        """Return a boolean. For `live` see `Declaration`."""
        value = self._get(name, default, "true or false")
        if not isinstance(value, bool):
            self.fail(name, value, "true or false")
        return self._declare(name, bool(value), "true or false", (False, True), live)

    def texts(self, name: str, default: object = _REQUIRED) -> tuple[str, ...]:
        """Return a list of strings."""
        value = self._get(name, default, "a list of texts")
        if not isinstance(value, (list, tuple)) or not all(isinstance(each, str) for each in value):
            self.fail(name, value, "a list of texts")
        return self._declare(name, tuple(value), "a list of texts")

    def points(self, name: str, default: object = _REQUIRED) -> tuple[tuple[float, float], ...]:
        """Return a list of [x, y] points, which may be given as text (move_base's footprints may be either)."""
        value = self._get(name, default, "a list of [x, y] points")
        try:
            listed = (load_yaml(value) if isinstance(value, str) else value) or ()
            if not isinstance(listed, Iterable):
                raise TypeError
            return self._declare(name, tuple((float(x), float(y)) for x, y in listed), "a list of [x, y] points")
        except (TypeError, ValueError):
            self.fail(name, value, "a list of [x, y] points")

    def fail(self, name: str, value: object, expected: str, choices: Iterable[str] = ()) -> NoReturn:
        """Raise UserError with the parameter, its value and the expected one."""
        near = did_you_mean(str(value), choices)
        raise user_error(
            f"parameter {self.name(name)}: {value!r}, expected {expected}",
            rule="bad-parameter",
            help=f"did you mean {near!r}?" if near else None,
        )

    def _get(self, name: str, default: object, expected: str) -> object:
        """Return what the user has given; while it is read again, what he had given at the start or has changed."""
        given, full = self._reads.given, self.name(name)
        if not (self._reads.again and full in given):
            try:
                given[full] = self._store.get(self._namespace + name)
            except KeyError:
                given[full] = _ABSENT
        if given[full] is not _ABSENT:
            return given[full]
        if default is _REQUIRED:
            raise user_error(f"parameter {full} is not set, expected {expected}", rule="missing-parameter")
        return default

    def _declare(self, name: str, value: Value, expected: str, limits: Limits = _ANY, live: str = "") -> Value:
        full, declared = self.name(name), self._reads.declared
        if live or full not in declared or not declared[full].live:  # a second read does not end that it is live
            declared[full] = Declaration(value, expected, limits, live)
        return value


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
