"""Parts of requests that several kinds have in common: numbers, names and poses from a browser, checked."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from typing import Any, TypeVar, cast

Reader = TypeVar("Reader", bound=Callable[..., object])

LONGEST_NAME = 64
"""Characters of the longest name of a place."""

FARTHEST = 1e5
"""m: the largest coordinate."""

_MOST = 2**32


class BadRequestError(ValueError):
    """A message that is no request; its text says why, in a line."""


def read_object(text: object, longest: int) -> dict[str, Any]:
    """The JSON object that a text of at most `longest` characters is. Raises BadRequestError."""
    if not isinstance(text, str) or len(text) > longest:
        raise BadRequestError(f"expected a text of at most {longest} characters")
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        raise BadRequestError("expected JSON") from None
    if not isinstance(value, dict):
        raise BadRequestError("expected a JSON object")
    return value


def choose_reader(value: Mapping[str, Any], readers: Mapping[str, Reader]) -> Reader:
    """The reader for the kind of a request, its field `t`. Raises BadRequestError."""
    kind = value.get("t")
    reader = readers.get(kind) if isinstance(kind, str) else None
    if reader is None:
        raise BadRequestError(f"t: expected one of {', '.join(readers)}")
    return reader


def is_count(value: object) -> bool:
    """Tell whether a value is a whole number from 0 to 2^32 - 1; JSON's true and false are none."""
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < _MOST


def read_number(value: Mapping[str, Any], name: str, most: float) -> float:
    """The finite number from -most to most in a field. Raises BadRequestError."""
    found = value.get(name)
    good = isinstance(found, (int, float)) and not isinstance(found, bool) and abs(found) <= most
    if not good or not math.isfinite(float(cast("float", found))):
        raise BadRequestError(f"{name}: expected a number from {-most:g} to {most:g}")
    return float(cast("float", found))


def read_pose(value: Mapping[str, Any]) -> tuple[float, float, float]:
    """The fields x, y (m) and yaw (rad). Raises BadRequestError."""
    return read_number(value, "x", FARTHEST), read_number(value, "y", FARTHEST), read_number(value, "yaw", 7.0)


def read_name(value: Mapping[str, Any], key: str = "place") -> str:
    """The name in a field. Raises BadRequestError."""
    name = value.get(key)
    if not isinstance(name, str) or not 0 < len(name) <= LONGEST_NAME or not name.isprintable():
        raise BadRequestError(f"{key}: expected a name of at most {LONGEST_NAME} characters")
    return name
