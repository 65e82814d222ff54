"""Parameters of a node, typed, with errors that name the parameter and what was expected."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterable, Mapping
from typing import NoReturn, Protocol, TypeGuard

from ur.source.diagnostic import UserError, error
from ur.source.foreign.yaml_text import load_yaml
from ur.source.suggest import did_you_mean

_REQUIRED: object = object()


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

    def names(self) -> list[str]:
        """The full names of all parameters of the run."""


class Parameters:
    """Reads parameters below `namespace` ('~' is the node itself). Raises UserError."""

    def __init__(self, store: ParameterStore, namespace: str = "~") -> None:
        self._store = store
        self._namespace = namespace

    def below(self, name: str) -> Parameters:
        """Return the parameters of a sub-namespace."""
        return Parameters(self._store, f"{self._namespace}{name}/")

    def of(self, node: str) -> Parameters:
        """Return the parameters of another node, by its name."""
        return Parameters(self._store, f"{node}/")

    def has(self, name: str) -> bool:
        """Return True when the parameter is set."""
        return self._store.has(self._namespace + name)

    def any(self, name: str, default: object = None) -> object:
        """Return the unchecked value; `default` if it is not set."""
        try:
            return self._store.get(self._namespace + name)
        except KeyError:
            return default

    def keep(self, name: str, value: object) -> None:
        """Set a parameter, which the node reads when it is restarted."""
        self._store.set(self._namespace + name, value)

    def keep_all(self, values: Mapping[str, object]) -> None:
        """Set parameters, unless the store has ended."""
        with contextlib.suppress(OSError):
            for name, value in values.items():
                self.keep(name, value)

    def names(self) -> list[str]:
        """Return the full names of all parameters of all nodes of the run."""
        return self._store.names()

    def name(self, name: str) -> str:
        """Return the full name of a parameter, for messages."""
        return self._store.resolve(self._namespace + name)

    def number(
        self, name: str, default: object = _REQUIRED, *, minimum: float = -math.inf, maximum: float = math.inf
    ) -> float:
        """Return a finite number within limits (inclusive)."""
        value = self._get(name, default, "a number")
        if not _is_number(value) or not minimum <= value <= maximum:
            limits = "" if (minimum, maximum) == (-math.inf, math.inf) else f" from {minimum:g} to {maximum:g}"
            self.fail(name, value, f"a number{limits}")
        return float(value)

    def integer(self, name: str, default: object = _REQUIRED, *, minimum: int | None = None) -> int:
        """Return an integer of at least `minimum`."""
        value = self._get(name, default, "a whole number")
        if not isinstance(value, int) or isinstance(value, bool) or (minimum is not None and value < minimum):
            at_least = "" if minimum is None else f" of at least {minimum}"
            self.fail(name, value, f"a whole number{at_least}")
        return int(value)

    def text(self, name: str, default: object = _REQUIRED, *, choices: Iterable[str] = ()) -> str:
        """Return a string; with `choices`, one of them."""
        value = self._get(name, default, "a text")
        allowed = list(choices)
        if not isinstance(value, str) or (allowed and value not in allowed):
            self.fail(name, value, f"one of {', '.join(allowed)}" if allowed else "a text", allowed)
        return str(value)

    def boolean(self, name: str, default: object = _REQUIRED) -> bool:
        """Return a boolean."""
        value = self._get(name, default, "true or false")
        if not isinstance(value, bool):
            self.fail(name, value, "true or false")
        return bool(value)

    def texts(self, name: str, default: object = _REQUIRED) -> tuple[str, ...]:
        """Return a list of strings."""
        value = self._get(name, default, "a list of texts")
        if not isinstance(value, (list, tuple)) or not all(isinstance(each, str) for each in value):
            self.fail(name, value, "a list of texts")
        return tuple(value)

    def points(self, name: str, default: object = _REQUIRED) -> tuple[tuple[float, float], ...]:
        """Return a list of [x, y] points, which may be given as text (move_base's footprints may be either)."""
        value = self._get(name, default, "a list of [x, y] points")
        try:
            listed = load_yaml(value) if isinstance(value, str) else value
            if not listed:
                return ()
            if not isinstance(listed, Iterable):
                raise TypeError
            return tuple((float(x), float(y)) for x, y in listed)
        except (TypeError, ValueError):
            self.fail(name, value, "a list of [x, y] points")

    def fail(self, name: str, value: object, expected: str, choices: Iterable[str] = ()) -> NoReturn:
        """Raise UserError with the parameter, its value and the expected one."""
        near = did_you_mean(str(value), choices)
        raise UserError(
            error(
                f"parameter {self.name(name)}: {value!r}, expected {expected}",
                rule="bad-parameter",
                help=f"did you mean {near!r}?" if near else None,
            )
        )

    def _get(self, name: str, default: object, expected: str) -> object:
        try:
            return self._store.get(self._namespace + name)
        except KeyError:
            if default is not _REQUIRED:
                return default
        raise UserError(error(f"parameter {self.name(name)} is not set, expected {expected}", rule="missing-parameter"))


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
