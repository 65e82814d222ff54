"""The three kinds of formats in `$(eval ...)`, limited in length and in the attributes they reach."""

import _string  # type: ignore[import-not-found]  # the base of string.Formatter, whose import takes longer
import re
from collections.abc import Callable, Mapping
from typing import Any

from ur.launchfile.plan.values.budget import MAX_SIZE, ExpressionProblem

MAX_WIDTH = 20_000
CONVERSIONS: Mapping[str, Callable[[object], str]] = {"s": str, "r": repr, "a": ascii}


def apply_format(left: Any, right: object) -> object:
    """Compute `left % right`: a remainder, or a formatted text."""
    if isinstance(left, (str, bytes)):
        text = left if isinstance(left, str) else left.decode("latin-1")
        if "*" in text:
            raise ExpressionProblem("a format with a width of '*'")
        _check_widths(text)
    return left % right


def _check_widths(pattern: str) -> None:
    widest = sum(int(number[:9]) for number in re.findall(r"\d+", pattern, re.ASCII))
    if widest > MAX_WIDTH:
        raise ExpressionProblem(f"a format that asks for {widest:,} characters, expected at most {MAX_WIDTH:,}")


def format_value(value: object, pattern: str) -> str:
    """Format like Python's `format`, except for patterns that result in huge texts."""
    _check_widths(pattern)
    return format(value, pattern)


def format_text(text: str, *arguments: object, **keywords: object) -> str:
    """Format like Python's `str.format`, with access to items and plain attributes of a value only.

    Python's own reaches everything: from a function its globals, and from there the environment.
    """
    automatic = total = 0

    def write(pattern: str, depth: int) -> str:
        nonlocal automatic, total
        if depth < 0:
            raise ValueError("Max string recursion exceeded")
        pieces = []
        for literal, field, spec, conversion in _string.formatter_parser(pattern):
            pieces.append(literal)
            if field is None:
                continue
            first, rest = _string.formatter_field_name_split(field)
            if first == "":
                first, automatic = automatic, automatic + 1
            value: Any = arguments[first] if isinstance(first, int) else keywords[first]
            for is_attribute, name in rest:
                value = _find_attribute(value, name) if is_attribute else value[name]
            if conversion:
                value = CONVERSIONS[conversion](value)
            pieces.append(format_value(value, write(spec or "", depth - 1)))
            total += len(pieces[-1])
            if total > MAX_SIZE:
                raise ExpressionProblem(f"a text of more than {MAX_SIZE:,} characters")
        return "".join(pieces)

    return write(text, 2)


def _find_attribute(value: object, name: str) -> object:
    if isinstance(value, (int, float, complex)) and name in ("real", "imag", "numerator", "denominator"):
        return getattr(value, name)
    raise AttributeError(f"'{type(value).__name__}' has no '{name}' that may be used in a format")
