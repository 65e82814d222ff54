"""Parsing of numbers in texts from other programs and computers; None for an invalid one."""

import re

_INTEGER = re.compile(r"[+-]?[0-9]{1,18}")
_DECIMAL = re.compile(r"[+-]?(?:[0-9]{1,18}(?:\.[0-9]{0,30})?|\.[0-9]{1,30})(?:[eE][+-]?[0-9]{1,2})?")


def parse_integer(text: str, base: int = 10) -> int | None:
    """Parse an integer of at most 18 ASCII digits; None for any other text."""
    if _INTEGER.fullmatch(text) is None:
        return None
    try:
        return int(text, base)
    except ValueError:
        return None  # a digit that the base does not have


def parse_decimal(text: str) -> float | None:
    """Parse a finite number in decimal or scientific notation; None for any other text."""
    return float(text) if _DECIMAL.fullmatch(text) else None
