"""Functions and operators of `$(eval ...)`, limited in time and memory."""

import _string  # type: ignore[import-not-found]  # the base of string.Formatter, whose import takes longer
import ast
import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping
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


MAX_BITS = 200_000
MAX_STEP = 2_000


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_METHODS: Mapping[type, frozenset[str]] = {
    str: _words(
        "capitalize casefold center count endswith expandtabs find format index isalnum isalpha isascii "
        "isdecimal isdigit isidentifier islower isnumeric isprintable isspace istitle isupper join ljust "
        "lower lstrip partition removeprefix removesuffix replace rfind rindex rjust rpartition rsplit rstrip "
        "split splitlines startswith strip swapcase title upper zfill "
    ),
    list: _words("count index copy "),
    tuple: _words("count index "),
    dict: _words("get items keys values copy "),
    float: _words("is_integer as_integer_ratio hex real imag conjugate "),
    int: _words("bit_length real imag numerator denominator conjugate "),
    set: _words("union intersection difference issubset issuperset isdisjoint copy "),
}


def size_of(value: object) -> int:
    """Return the size of a value: characters, items, or bits / 8. Raises ExpressionProblem if it is too large."""
    if isinstance(value, (str, bytes, list, tuple, dict, set, frozenset)):
        size = len(value)
    elif isinstance(value, int):
        size = value.bit_length() // 8
    else:
        return 0
    if size > MAX_SIZE:
        raise ExpressionProblem(f"a value with {size:,} parts, expected at most {MAX_SIZE:,}")
    return size


def _check_product(size: int, times: object) -> None:
    if isinstance(times, int) and size * times > MAX_SIZE:
        raise ExpressionProblem(f"a value with {size * times:,} parts, expected at most {MAX_SIZE:,}")


def _multiply(left: Any, right: Any) -> object:
    for value, times in ((left, right), (right, left)):
        if isinstance(value, (str, bytes, list, tuple)):
            _check_product(len(value), times)
    if isinstance(left, int) and isinstance(right, int):
        _check_bits(left.bit_length() + right.bit_length())
    return left * right


def _check_bits(bits: int) -> None:
    if bits > MAX_BITS:
        raise ExpressionProblem(f"a number of {bits:,} bits, expected at most {MAX_BITS:,}")


def _power(base: Any, exponent: Any, modulus: int | None = None) -> object:
    if isinstance(base, int) and isinstance(exponent, int):
        if modulus is not None:
            return pow(base, exponent, modulus)
        _check_bits(base.bit_length() * abs(exponent))
    return pow(base, exponent)


def _shift_left(value: Any, bits: Any) -> object:
    if isinstance(value, int) and isinstance(bits, int):
        _check_bits(value.bit_length() + max(bits, 0))
    return value << bits


def _make_range(*limits: int) -> range:
    made = range(*limits)
    _check_product(len(made), 1)
    return made


def _round(number: float, digits: int | None = None) -> object:
    if isinstance(digits, int) and abs(digits) > MAX_STEP:
        raise ExpressionProblem(f"{digits} digits, expected at most {MAX_STEP}")
    return round(number) if digits is None else round(number, digits)


def _sum(items: Iterable[int], /, start: object = 0) -> object:
    if not isinstance(start, (int, float)):
        raise TypeError("sum() of something other than numbers")
    return sum(items, start)


def _small(function: Callable[..., object]) -> Callable[..., object]:
    def bounded(*numbers: object, **keywords: object) -> object:
        for number in numbers:
            if isinstance(number, int) and abs(number) > MAX_STEP:
                raise ExpressionProblem(f"{number}, expected at most {MAX_STEP}")
        return function(*numbers, **keywords)

    return bounded


def _product(items: Iterable[object], /, *, start: object = 1) -> object:
    for item in items:
        start = _multiply(start, item)
    return start


def _least_common(*numbers: int) -> object:
    _check_bits(sum(number.bit_length() for number in numbers if isinstance(number, int)))
    return math.lcm(*numbers)


def _listed(function: Callable[..., Iterable[object]]) -> Callable[..., object]:
    # What Python computes step by step is computed at once: nothing may run later, outside of our limits.
    return lambda *arguments, **keywords: iter(list(function(*arguments, **keywords)))


def find_method(value: object, name: str) -> object:
    """Return a method or plain attribute of a value that is safe to use. Raises AttributeError."""
    for type_, names in _METHODS.items():
        if isinstance(value, type_) and name in names:
            return _bounded_method(value, name) if isinstance(value, str) else getattr(value, name)
    raise AttributeError(f"'{type(value).__name__}' has no '{name}' that may be used here")


def _bounded_method(text: str, name: str) -> Callable[..., object]:
    def call(*arguments: Any, **keywords: object) -> object:
        if name in ("ljust", "rjust", "center", "zfill", "expandtabs"):
            for argument in [*arguments, *keywords.values()]:
                _check_product(max(len(text), 1), argument if name == "expandtabs" else 1)
                _check_product(1, argument)
        elif name == "replace" and len(arguments) > 1 and isinstance(arguments[1], str):
            _check_product(len(text) + 1, len(arguments[1]))
        elif name == "join":
            arguments = ([*arguments[0]], *arguments[1:]) if arguments else arguments
            for part in arguments[:1]:
                _check_product(len(part), len(text))
        elif name == "format":
            return format_text(text, *arguments, **keywords)
        return getattr(text, name)(*arguments, **keywords)

    return call


CONSTANTS: Mapping[str, object] = {"true": True, "false": False, "True": True, "False": False}

MATH: Mapping[str, object] = {
    **{name: getattr(math, name) for name in dir(math) if not name.startswith("_")},
    **{name: _small(getattr(math, name)) for name in ("factorial", "comb", "perm")},
    "prod": _product,
    "lcm": _least_common,
}

BUILTINS: Mapping[str, object] = {
    **{
        function.__name__: function
        for function in (
            abs,
            all,
            any,
            bin,
            bool,
            chr,
            dict,
            divmod,
            float,
            frozenset,
            hash,
            hex,
            int,
            len,
            max,
            min,
            oct,
        )
    },
    **{function.__name__: function for function in (list, ord, set, slice, tuple, callable, complex, sorted)},
    **{function.__name__: _listed(function) for function in (enumerate, filter, map, reversed, zip)},
    "ascii": ascii,
    "repr": repr,
    "str": str,
    "format": lambda value, pattern="": format_value(value, pattern),
    "pow": _power,
    "range": _make_range,
    "round": _round,
    "sum": _sum,
    "None": None,
}

FORBIDDEN = _words(
    "breakpoint bytearray bytes classmethod compile copyright credits delattr dir eval exec exit getattr "
    "globals hasattr help id input isinstance issubclass iter license locals memoryview next object open "
    "print property quit setattr staticmethod super type vars "
)

UNARY: Mapping[type[ast.unaryop], Callable[[Any], object]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: operator.invert,
}

BINARY: Mapping[type[ast.operator], Callable[[Any, Any], object]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _multiply,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: apply_format,
    ast.Pow: _power,
    ast.LShift: _shift_left,
    ast.RShift: operator.rshift,
    ast.BitOr: operator.or_,
    ast.BitAnd: operator.and_,
    ast.BitXor: operator.xor,
}

COMPARE: Mapping[type[ast.cmpop], Callable[[Any, Any], object]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda left, right: left in right,
    ast.NotIn: lambda left, right: left not in right,
}
