"""Parsing of numbers in a robot description."""

import math

MOST = 1e6


def read_numbers(text: str) -> tuple[float, ...] | None:
    """Parse numbers separated by whitespace; None if one is not a finite number, or greater than MOST."""
    try:
        numbers = tuple(float(word) for word in text.split())
    except ValueError:
        return None
    return numbers if all(math.isfinite(number) and abs(number) <= MOST for number in numbers) else None


def read_number(text: str | None) -> float | None:
    """Parse one number; None for any other text."""
    numbers = read_numbers(text or "")
    return numbers[0] if numbers and len(numbers) == 1 else None
