"""Message definitions of ROS 1 as values, from the text that a publisher sends when a subscriber connects.

`genpy.dynamic` makes Python code of such a text and runs it; the text comes from the network, so it is read here.
"""

import re
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

LONGEST = 200_000
"""Characters of the longest definition."""

_NUMBERS = "bool ? byte b char B int8 b int16 h int32 i int64 q uint8 B uint16 H uint32 I uint64 Q float32 f float64 d"
PRIMITIVES: Mapping[str, str] = dict(zip(_NUMBERS.split()[::2], _NUMBERS.split()[1::2], strict=True))
"""Formats of `struct` by type; the length of a format is that of the type in bytes."""

MOMENTS = frozenset({"time", "duration"})
_MOST_KINDS = 200
_MOST_FIELDS = 400
_DEEPEST = 12
_MOST_FIXED = 1_000_000
_SEPARATOR = re.compile(r"^={10,}[ \t]*$", re.MULTILINE)
_NAME = r"[A-Za-z][A-Za-z0-9_]{0,99}"
_KIND = re.compile(rf"({_NAME}/)?{_NAME}", re.ASCII)
_FIELD = re.compile(rf"((?:{_NAME}/)?{_NAME})(?:\[([0-9]{{0,9}})\])?[ \t]+({_NAME})", re.ASCII)


class BadDefinitionError(ValueError):
    """A text that is no definition; its message is the reason, on one line."""


@dataclass(frozen=True, slots=True)
class Field:
    """A field: its type, and None, the number of its elements, or -1 for an array with its own length."""

    name: str
    kind: str
    length: int | None = None


@dataclass(frozen=True, slots=True)
class Definition:
    """The type of a message, and the fields of each type that it holds."""

    kind: str
    fields: Mapping[str, tuple[Field, ...]]

    def sizes(self) -> Mapping[str, int | None]:
        """The bytes of each type; None where they depend on the message."""
        sizes: dict[str, int | None] = {}
        for kind in self.fields:
            _measure(self, kind, sizes)
        return sizes


def size_of_primitive(kind: str) -> int | None:
    """Return the size in bytes of a primitive type; None for a string and for message types."""
    if kind in MOMENTS:
        return 8
    form = PRIMITIVES.get(kind)
    return None if form is None else struct.calcsize("<" + form)


@lru_cache(maxsize=64)
def read_definition(kind: str, text: str) -> Definition:
    """Read the definition of a type from its full text. Raises BadDefinitionError."""
    if len(text) > LONGEST:
        raise BadDefinitionError(f"definition of {len(text)} characters, expected at most {LONGEST}")
    if _KIND.fullmatch(kind) is None or "/" not in kind:
        raise BadDefinitionError("type: expected PACKAGE/NAME")
    first, *rest = _SEPARATOR.split(text)
    if len(rest) >= _MOST_KINDS:
        raise BadDefinitionError(f"definition of {len(rest)} types, expected fewer than {_MOST_KINDS}")
    texts = {kind: first}
    for part in rest:
        head, _, body = part.lstrip("\n").partition("\n")
        name = head.removeprefix("MSG:").strip()
        if not head.startswith("MSG:") or _KIND.fullmatch(name) is None or "/" not in name:
            raise BadDefinitionError("definition without the line 'MSG: PACKAGE/NAME' before a type")
        texts.setdefault(name, body)
    fields = {name: tuple(_read_fields(name, body, texts)) for name, body in texts.items()}
    found = Definition(kind, fields)
    depths: dict[str, int] = {}
    for name in fields:
        _find_depth(found, name, depths)
    return found


def _read_fields(kind: str, text: str, known: Mapping[str, str]) -> Iterator[Field]:
    count = 0
    for each in text.split("\n"):
        line = each.split("#", 1)[0].strip()
        if not line or "=" in line:  # a constant has no bytes
            continue
        match = _FIELD.fullmatch(line)
        count += 1
        if match is None or count > _MOST_FIELDS:
            raise BadDefinitionError(f"{kind}: expected at most {_MOST_FIELDS} fields, each as TYPE NAME")
        length = None if match[2] is None else int(match[2] or -1)
        if length is not None and length > _MOST_FIXED:
            raise BadDefinitionError(f"{kind}.{match[3]}: array of {length}, expected at most {_MOST_FIXED}")
        yield Field(match[3], _resolve(match[1], kind, known), length)


def _resolve(name: str, within: str, known: Mapping[str, str]) -> str:
    """Return the full name of a type that a field of another type names."""
    if name in PRIMITIVES or name in MOMENTS or name == "string":
        return name
    if name == "Header":
        name = "std_msgs/Header"
    elif "/" not in name:
        name = f"{within.partition('/')[0]}/{name}"
    if name not in known:
        raise BadDefinitionError(f"{within}: the type {name} is not in the definition")
    return name


def _find_depth(definition: Definition, kind: str, depths: dict[str, int]) -> int:
    """Return the nesting depth of a type. Raises BadDefinitionError if it contains itself or is too deep."""
    if kind not in depths:
        depths[kind] = _DEEPEST  # until it is known: a type that holds itself finds this
        inner = {each.kind for each in definition.fields[kind]} & definition.fields.keys()
        depth = 1 + max((_find_depth(definition, each, depths) for each in sorted(inner)), default=0)
        if depth > _DEEPEST:
            raise BadDefinitionError(f"{kind}: types within one another, expected at most {_DEEPEST} levels")
        depths[kind] = depth
    return depths[kind]


def _measure(definition: Definition, kind: str, sizes: dict[str, int | None]) -> int | None:
    if kind not in definition.fields:
        return size_of_primitive(kind)
    if kind not in sizes:
        total: int | None = 0
        for field in definition.fields[kind]:
            size = None if field.length == -1 else _measure(definition, field.kind, sizes)
            total = (
                None if size is None or total is None else total + size * (1 if field.length is None else field.length)
            )
        sizes[kind] = total
    return sizes[kind]
