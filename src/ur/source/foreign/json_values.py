"""Untrusted JSON, decoded to values: types declare limits, and a text beyond them is refused.

A limit is declared with its field: `Annotated[int, Meta(ge=0, le=100)]` or one of the types below. Subclasses of
`ForeignValue` refuse unknown fields; dataclasses ignore them, so that versions of a program understand each other.
Where start-up time matters, import this module in a function.
"""

import json
from collections.abc import Mapping
from enum import Enum
from functools import lru_cache
from types import NoneType
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin, get_type_hints, overload

import msgspec
from msgspec import Meta

Kind = TypeVar("Kind")

Count = Annotated[int, Meta(ge=0, lt=2**32, description="a whole number below 2^32")]
Timestamp = Annotated[float, Meta(ge=0.0, lt=1e11, description="seconds since 1970")]

Stamp = Annotated[tuple[Count, Count], Meta(description="a challenge, two whole numbers below 2^32")]
"""Seconds and nanoseconds of a challenge of the mux."""

_ANY_TEXT = 1 << 20
_NOUNS = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "text",
    tuple: "a list",
    list: "a list",
    dict: "a JSON object",
}


class BadJsonError(ValueError):
    """A text that is not JSON, or not a value of the expected type. The message is the reason, in one line."""


class ForeignValue(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A value from outside: frozen, and without unknown fields."""


class PrintableValue(ForeignValue, frozen=True):
    """A value whose texts are checked to be printable, each on one line."""


@overload
def read_json(text: object, kind: type[Kind], longest: int = _ANY_TEXT) -> Kind: ...
@overload
def read_json(text: object, kind: object, longest: int = _ANY_TEXT) -> Any: ...
def read_json(text: object, kind: Any, longest: int = _ANY_TEXT) -> Any:
    """Decode a text of at most `longest` characters or bytes to a type. Raises BadJsonError."""
    if not isinstance(text, (str, bytes)) or len(text) > longest:
        raise BadJsonError(f"expected a text of at most {longest} characters")
    try:
        return _check(_decoder(kind).decode(text))
    except msgspec.ValidationError as problem:
        raise BadJsonError(_explain(text, kind, str(problem))) from None
    except (msgspec.MsgspecError, RecursionError, UnicodeError):
        raise BadJsonError("expected JSON") from None


def read_json_names(text: str, kind: type[Kind], longest: int) -> Kind:
    """Decode like `read_json` a text with file names that are not UTF-8, which Python stores as surrogates."""
    if len(text) > longest:
        raise BadJsonError(f"expected a text of at most {longest} characters")
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        raise BadJsonError("expected JSON") from None
    return convert_json(value, kind)


@overload
def convert_json(value: object, kind: type[Kind]) -> Kind: ...
@overload
def convert_json(value: object, kind: object) -> Any: ...
def convert_json(value: object, kind: Any) -> Any:
    """Convert parsed JSON to a type. Raises BadJsonError."""
    try:
        return _check(msgspec.convert(value, kind))
    except msgspec.ValidationError as problem:
        raise BadJsonError(_explain_value(value, kind, str(problem))) from None
    except RecursionError:
        raise BadJsonError("nested too deeply") from None


def write_json(value: object) -> str:
    """Encode a value as JSON in one line. A number that is not finite becomes null, a lone surrogate '?'."""
    try:
        return msgspec.json.encode(value).decode()
    except UnicodeEncodeError:  # bytes of a file's name that are not UTF-8, as Python holds them
        text = json.dumps(msgspec.to_builtins(value), ensure_ascii=False)
        return text.encode("utf-8", "replace").decode()


def write_json_names(value: object) -> str:
    """Encode a value as JSON for `read_json_names`."""
    return json.dumps(msgspec.to_builtins(value))


@lru_cache(maxsize=256)
def _decoder(kind: Any) -> msgspec.json.Decoder[Any]:
    return msgspec.json.Decoder(kind)


def _check(value: Any) -> Any:
    if isinstance(value, PrintableValue):
        for name in value.__struct_fields__:
            if not _is_printable(getattr(value, name)):
                field = next(each for each in msgspec.structs.fields(value) if each.name == name)
                raise BadJsonError(_expect(field.encode_name, field.type))
    return value


def _explain(text: str | bytes, kind: Any, problem: str) -> str:
    try:
        value = msgspec.json.decode(text)
    except (msgspec.MsgspecError, RecursionError, UnicodeError):
        return "expected JSON"
    return _explain_value(value, kind, problem)


def _explain_value(value: object, kind: Any, problem: str) -> str:
    from dataclasses import is_dataclass  # with inspect, and rarely needed

    kinds = [each for each in get_args(kind) or (kind,) if hasattr(each, "__struct_config__") or is_dataclass(each)]
    if not kinds:
        return f"expected {describe_type(kind)}"
    if not isinstance(value, dict):
        return "expected a JSON object"
    kind, tag = kinds[0], getattr(kinds[0], "__struct_config__", None) and kinds[0].__struct_config__.tag_field
    if tag is not None:
        known = {each.__struct_config__.tag: each for each in kinds}
        name = value.get(tag)
        if not isinstance(name, str) or name not in known:
            return f"{tag}: expected one of {', '.join(known)}"
        kind = known[name]
    known_fields = _list_fields(kind)
    for name, (hint, required) in known_fields.items():
        if (name in value and not _fits(value[name], hint)) or (name not in value and required):
            return _expect(name, hint)
    names = [*([tag] if tag else []), *known_fields]
    unknown = None if is_dataclass(kind) else next((name for name in value if name not in names), None)
    return problem if unknown is None else f"{unknown[:40]!r}: expected one of {', '.join(names)}"


def _list_fields(kind: Any) -> dict[str, tuple[Any, bool]]:
    """Return the types of fields by their names in JSON, and whether each is required."""
    from dataclasses import MISSING, fields, is_dataclass

    if not is_dataclass(kind):
        return {each.encode_name: (each.type, each.required) for each in msgspec.structs.fields(kind)}
    hints = get_type_hints(kind, include_extras=True)
    return {
        each.name: (hints[each.name], each.default is MISSING and each.default_factory is MISSING)
        for each in fields(kind)
    }


def _fits(value: object, kind: Any) -> bool:
    try:
        msgspec.convert(value, kind)
    except msgspec.ValidationError:
        return False
    return True


def _expect(name: str, kind: Any) -> str:
    return f"{name}: expected {describe_type(kind)}"


def describe_type(kind: Any) -> str:
    """Describe the values of a type: its description, or its limits."""
    found = get_origin(kind)
    if found is Annotated:
        inner, *metas = get_args(kind)
        meta = next(each for each in metas if isinstance(each, Meta))
        return meta.description or _describe_limits(inner, meta)
    if isinstance(kind, type) and issubclass(kind, Enum):
        return f"one of {', '.join(str(each.value) for each in kind)}"
    if found is Literal:
        return f"one of {', '.join(map(str, get_args(kind)))}"
    for each in get_args(kind) if NoneType in get_args(kind) else ():
        return describe_type(each)
    return _NOUNS.get(found or kind, "an object")


def _describe_limits(inner: Any, meta: Meta) -> str:
    noun = describe_type(inner)
    if meta.ge is not None and meta.le is not None:
        return f"{noun} from {meta.ge:g} to {meta.le:g}"
    return noun if meta.max_length is None else f"{noun} of at most {meta.max_length}"


def _is_printable(value: object) -> bool:
    if isinstance(value, str):
        return value.isprintable()
    if isinstance(value, Mapping):
        return all(map(_is_printable, value)) and all(map(_is_printable, value.values()))
    if names := getattr(value, "__dataclass_fields__", ()):
        return all(_is_printable(getattr(value, each)) for each in names)
    return not isinstance(value, (tuple, list)) or all(map(_is_printable, value))
