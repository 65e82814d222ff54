"""Limits on the computation for a launch file: units of work, charged before it is done. Pure.

Expressions, angles, YAML texts and parameters of a file, with all its includes, share one budget. A unit is some tenths
of a microsecond, and at most about 100 bytes. `weigh` is linear in the data that a Python function reads; functions
that take more than linear time have separate costs (`COSTS`).
"""

from collections.abc import Callable, ItemsView, Iterable, KeysView, Mapping, Sequence, ValuesView
from operator import length_hint
from typing import Any

PER_EXPRESSION = 3_000_000
PER_FILE = 5_000_000  # with all that it includes, for all bases and options that `ur check` tries
PER_PARAMETER = 20
PER_YAML_CHARACTER = 4  # with PyYAML's own parser; libyaml's takes a quarter
PER_STEP = 5
PER_FUNCTION = 50  # a lambda, a method that is taken from a value
MAX_SIZE = 1_000_000
_COLLISIONS = 64
_POWER = 10_000  # the same for three arguments of pow
_ITERATOR: type = type(iter([]))
_DIVISION = 180_000  # square bits per unit: schoolbook division


class ExpressionProblem(Exception):  # noqa: N818 - carries a finding to where its place is known
    """Something is wrong with an expression. `start` and `end` are offsets in it; equal if the position is unknown.

    `subject` and `kind` are as in a Diagnostic.
    """

    def __init__(
        self, message: str, start: int = 0, end: int = 0, help: str | None = None, *, subject: str = "", kind: str = ""
    ) -> None:
        super().__init__(message)
        self.start = start
        self.end = end
        self.help = help
        self.subject = subject
        self.kind = kind


class TooLong(Exception):  # noqa: N818 - carries a finding to where its place is known
    """The budget is spent."""


class Budget:
    """The remaining budget of one file. `begin` starts an expression, which may spend a share of it."""

    __slots__ = ("_end", "_least", "left")

    def __init__(self, units: int = PER_FILE) -> None:
        self.left = units
        self._end = self._least = 0

    def begin(self) -> None:
        """Start an expression."""
        self._end = self.left - PER_EXPRESSION
        self._least = max(self._end, 0)

    def end(self) -> None:
        """End an expression: what follows may spend all that is left."""
        self._end = self._least = 0

    def charge(self, units: int) -> None:
        """Charge units for work outside of expressions. Raises TooLong if too few are left."""
        self.left -= units
        if self.left < 0:
            self.left = 0
            raise TooLong("takes too long to read, together with all expressions, YAML and parameters of this file")

    def spend(self, units: int) -> None:
        """Charge units. Raises TooLong if too few are left."""
        self.left -= units
        if self.left < self._least:
            self.left = self._least
            whole = "the expressions of this file together take too long to compute"
            raise TooLong("takes too long to compute" if self._end >= 0 else whole)

    def weigh(self, *values: object) -> None:
        """Charge for the size of values, nested parts included, each as often as Python reads it."""
        pending: list[Iterable[Any]] = [values]
        while pending:
            items = pending.pop()
            units = 0
            for item in items:
                kind = type(item)
                if kind is str or kind is bytes:
                    units += 1 + len(item) // 8
                elif kind is int:
                    units += 1 + item.bit_length() // 16
                elif kind is range:
                    units += 1 + len(item)
                elif kind is dict:
                    units += 1
                    pending += [item, item.values()]
                elif kind is _ITERATOR:
                    units += 1
                    pending.append(item.__reduce__()[1][0])  # the list that it goes through
                elif isinstance(item, (list, tuple, set, frozenset, KeysView, ValuesView, ItemsView)):
                    units += 1
                    pending.append(item)
                else:
                    units += 1
            self.spend(units)


def hash_cost(size: int) -> int:
    """Return the cost of a set or dict with `size` entries if all have the same hash."""
    return size * size // _COLLISIONS


def divide_cost(left: object, right: object) -> int:
    """Return the cost of a division of integers, or of their greatest common divisor."""
    if isinstance(left, int) and isinstance(right, int):
        return left.bit_length() * right.bit_length() // _DIVISION
    return 0


def _power_cost(arguments: Sequence[Any], _: Mapping[str, object]) -> int:
    if len(arguments) == 3 and all(isinstance(each, int) for each in arguments):
        _, exponent, modulus = arguments
        steps = exponent.bit_length() if exponent >= 0 else modulus.bit_length()
        return int(steps * modulus.bit_length() ** 2 // _POWER)
    return 0


def _product_cost(arguments: Sequence[Any], _: Mapping[str, object]) -> int:
    sizes = [each.bit_length() for each in arguments[0] if isinstance(each, int)] if arguments else []
    return len(sizes) * sum(sizes) // 12_000


def _common_cost(arguments: Sequence[object], _: Mapping[str, object]) -> int:
    sizes = [each.bit_length() for each in arguments if isinstance(each, int)]
    return sum(sizes) * sum(sizes) // _DIVISION


def _combination_cost(arguments: Sequence[object], _: Mapping[str, object]) -> int:
    return max((abs(each) for each in arguments if isinstance(each, int)), default=0)


def _sort_cost(arguments: Sequence[object], _: Mapping[str, object]) -> int:
    size = _count(arguments)
    return size * size.bit_length()


def _hashed_cost(arguments: Sequence[object], keywords: Mapping[str, object]) -> int:
    return hash_cost(_count(arguments) + len(keywords))


def _count(values: Sequence[object]) -> int:
    return sum(length_hint(each) for each in values if hasattr(each, "__iter__"))


COSTS: Mapping[str, Callable[[Sequence[object], Mapping[str, object]], int]] = {
    **dict.fromkeys(("set", "frozenset", "dict"), _hashed_cost),
    **dict.fromkeys(("union", "intersection", "difference", "issubset", "issuperset", "isdisjoint"), _hashed_cost),
    **dict.fromkeys(("gcd", "lcm", "isqrt"), _common_cost),
    **dict.fromkeys(("comb", "factorial", "perm"), _combination_cost),
    "divmod": lambda arguments, _: divide_cost(*arguments) if len(arguments) == 2 else 0,
    "pow": _power_cost,
    "prod": _product_cost,
    "sorted": _sort_cost,
}
