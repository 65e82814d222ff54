"""Empty messages as JSON for forms, and the fields of a message from JSON. It does not import genpy."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

_NUMBERS = {f"{kind}{bits}" for kind in ("int", "uint") for bits in (8, 16, 32, 64)} | {"byte", "char"}
_DEEPEST = 8

FindClass = Callable[[str], Any]


class BadValueError(ValueError):
    """A value that does not fit a type; the text says why, in a line."""


def make_template(found: Any, find_class: FindClass, deepest: int = _DEEPEST) -> dict[str, Any]:
    """The fields of a message class with their empty values; arrays are empty."""
    return {
        name: _empty(kind, find_class, deepest - 1)
        for name, kind in zip(found.__slots__, found._slot_types, strict=True)  # noqa: SLF001 - genpy has no other name
    }


def _empty(kind: str, find_class: FindClass, deepest: int) -> Any:
    if "[" in kind:
        return []
    if kind == "bool":
        return False
    if kind in _NUMBERS:
        return 0
    if kind.startswith("float"):
        return 0.0
    if kind in ("time", "duration"):
        return {"secs": 0, "nsecs": 0}
    found = find_class(kind) if "/" in kind and deepest > 0 else None
    return "" if found is None else make_template(found, find_class, deepest)


def read_value(text: str) -> Any:
    """The value of a JSON text without numbers that are not finite. Raises BadValueError."""
    try:
        return json.loads(text, parse_constant=_refuse, parse_float=_read_float)
    except RecursionError:
        raise BadValueError("value: nested too deeply") from None
    except BadValueError:
        raise
    except ValueError as problem:
        raise BadValueError(f"value: expected JSON: {problem}") from None


def _refuse(name: str) -> Any:
    raise BadValueError(f"value: {name}, expected a finite number")


def _read_float(text: str) -> float:
    number = float(text)
    return number if math.isfinite(number) else _refuse(text)


def read_fields(text: str) -> dict[str, Any]:
    """The fields of a message or request, which JSON holds as an object. Raises BadValueError."""
    found = read_value(text or "{}")
    if not isinstance(found, dict):
        raise BadValueError("value: expected a JSON object with the fields")
    return found
