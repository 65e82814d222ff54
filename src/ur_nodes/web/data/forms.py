"""Empty messages as JSON for forms, and the fields of a message from JSON."""

from ur.source.foreign.json_values import BadJsonError, read_json
from ur_nodes.web.messages.definition import MOMENTS, PRIMITIVES, Definition

_DEEPEST = 8


class BadValueError(ValueError):
    """A value does not fit a type; the text is the reason, on one line."""


def make_template(definition: Definition, deepest: int = _DEEPEST) -> dict[str, object]:
    """Return the fields of a message with empty values; arrays are empty."""
    return _make_template(definition, definition.kind, deepest)


def _make_template(definition: Definition, kind: str, deepest: int) -> dict[str, object]:
    return {
        field.name: _empty(definition, field.kind, deepest - 1) if field.length is None else []
        for field in definition.fields[kind]
    }


def _empty(definition: Definition, kind: str, deepest: int) -> object:
    if kind == "bool":
        return False
    if kind in MOMENTS:
        return {"secs": 0, "nsecs": 0}
    if kind in PRIMITIVES:
        return 0.0 if kind.startswith("float") else 0
    return _make_template(definition, kind, deepest) if kind in definition.fields and deepest > 0 else ""


def read_value(text: str) -> object:
    """Parse a JSON text, whose numbers must be finite. Raises BadValueError."""
    try:
        return read_json(text, object)
    except BadJsonError as problem:
        raise BadValueError(f"value: {problem}, with finite numbers") from None


def read_fields(text: str) -> dict[str, object]:
    """Parse the fields of a message or request, a JSON object. Raises BadValueError."""
    found = read_value(text or "{}")
    if not isinstance(found, dict):
        raise BadValueError("value: expected a JSON object with the fields")
    return found
