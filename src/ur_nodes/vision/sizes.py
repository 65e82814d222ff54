"""Numbers and sizes of fiducials as parameters write them: "3, 7-9" and "3: 0.2, 7-9: 0.1"."""

from __future__ import annotations


def parse_numbers(text: str) -> frozenset[int]:
    """Numbers and ranges, separated by commas. Raises ValueError."""
    found: set[int] = set()
    for part in filter(None, (each.strip() for each in text.split(","))):
        first, dash, last = part.partition("-")
        found.update(range(int(first), int(last if dash else first) + 1))
    return frozenset(found)


def parse_sizes(text: str) -> dict[int, float]:
    """Numbers or ranges, a colon, and the edge in m; separated by commas. Raises ValueError."""
    found: dict[int, float] = {}
    for part in filter(None, (each.strip() for each in text.split(","))):
        numbers, colon, size = part.partition(":")
        if not colon or not 0.0 < float(size) < 100.0:
            raise ValueError(f"{part!r} is not NUMBER: SIZE")
        found |= dict.fromkeys(parse_numbers(numbers), float(size))
    return found
