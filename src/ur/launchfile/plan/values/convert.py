"""Conversion of texts to values, as in roslaunch."""

from ur.launchfile.plan.specs import ParamType, ParamValue

_TYPES: dict[str, ParamType] = {
    "auto": "auto",
    "str": "str",
    "string": "str",
    "int": "int",
    "double": "double",
    "bool": "bool",
    "boolean": "bool",
    "yaml": "yaml",
}
TYPE_NAMES = tuple(_TYPES)
CONDITIONS = ("true", "false", "1", "0")


def read_type(text: str) -> ParamType | None:
    """Return the type that a `type=` attribute names; None for one that roslaunch does not know."""
    return _TYPES.get(text.lower().strip())


def guess_value(text: str) -> bool | int | float | str:
    """Type `auto`: a number, a boolean or the text itself. An underscore keeps a number a text."""
    try:
        if "." in text:
            return float(text)
        if "_" not in text:
            return int(text)
    except ValueError:
        pass
    lowered = text.lower()
    if lowered in ("true", "false"):
        return lowered == "true"
    return text


def read_boolean(text: str) -> bool:
    """Parse type `bool`: true, false, 1 or 0 in any case. Raises ValueError."""
    lowered = text.lower().strip()
    if lowered in ("true", "1"):
        return True
    if lowered in ("false", "0"):
        return False
    raise ValueError("expected true, false, 1 or 0")


def convert_scalar(text: str, type_: ParamType) -> ParamValue:
    """Convert a text to a type other than `yaml`. Raises ValueError, whose text names the expected value."""
    if type_ == "auto":
        return guess_value(text)
    if type_ == "bool":
        return read_boolean(text)
    try:
        if type_ == "int":
            return int(text)
        if type_ == "double":
            return float(text)
    except ValueError:
        expected = "a whole number" if type_ == "int" else "a number"
        raise ValueError(f"expected {expected}") from None
    return text
