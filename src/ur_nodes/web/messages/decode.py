"""Decoding of messages into bounded values, by their definition: a publisher may send anything, of any length."""

import math
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ur.source.printable import printable
from ur_nodes.web.messages.definition import MOMENTS, PRIMITIVES, Definition, Field, size_of_primitive

_LENGTH = struct.Struct("<I")
_MOMENT = struct.Struct("<II")
_SPAN = struct.Struct("<ii")
_SAFE = 2**53  # whole numbers up to here are exact in a browser
_MOST_VALUES = 100_000
_MOST_STEPS = 50_000  # values that are read to be left out


class BadMessageError(ValueError):
    """Bytes that are no message of a type; the text is the reason, on one line."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """At most `items` of each array, `letters` of each text, and `values` in all."""

    items: int = 64
    letters: int = 1000
    values: int = 2000


@dataclass(frozen=True, slots=True)
class Cut:
    """An array that was cut after its first elements, or, with `items` None, bytes that were not read."""

    items: list[object] | None
    total: int


class _Reader:
    def __init__(self, definition: Definition, data: bytes, bounds: Bounds) -> None:
        self.definition, self.data, self.bounds = definition, data, bounds
        self.sizes = definition.sizes()
        self.at, self.values, self.steps = 0, 0, 0

    def take(self, size: int) -> int:
        """Advance by `size` bytes; return the offset of the first."""
        at = self.at
        if size > len(self.data) - at:
            raise BadMessageError(f"message of {len(self.data)} bytes ends within a field")
        self.at = at + size
        return at

    def size_of(self, kind: str) -> int | None:
        return self.sizes[kind] if kind in self.sizes else size_of_primitive(kind)

    def fields(self, kind: str) -> dict[str, object]:
        return {field.name: self.field(field) for field in self.definition.fields[kind]}

    def field(self, field: Field) -> object:
        if field.length is None:
            return self.value(field.kind)
        count = self.length() if field.length == -1 else field.length
        size = self.size_of(field.kind)
        if size is not None and count * size > len(self.data) - self.at:
            raise BadMessageError(f"{field.name}: {count} elements, and {len(self.data) - self.at} bytes are left")
        shown = min(count, self.bounds.items, max(0, self.bounds.values - self.values))
        items = [self.value(field.kind) for _ in range(shown)]
        if shown == count:
            return items
        if size is not None:
            self.take((count - shown) * size)
        else:
            for _ in range(count - shown):
                self.skip(field.kind)
        return Cut(items, count)

    def length(self) -> int:
        return int(_LENGTH.unpack_from(self.data, self.take(4))[0])

    def value(self, kind: str) -> object:
        self.values += 1
        if self.values > _MOST_VALUES:
            raise BadMessageError(f"more than {_MOST_VALUES} values outside of arrays")
        if kind in self.definition.fields:
            return self.fields(kind)
        if kind == "string":
            length = self.length()
            at = self.take(length)
            text = self.data[at : at + min(length, 4 * self.bounds.letters)].decode("utf-8", "replace")
            return text[: self.bounds.letters] + ("..." if len(text) > self.bounds.letters else "")
        if kind in MOMENTS:
            seconds, rest = (_MOMENT if kind == "time" else _SPAN).unpack_from(self.data, self.take(8))
            return round(seconds + rest * 1e-9, 9)
        form = PRIMITIVES[kind]
        found = struct.unpack_from("<" + form, self.data, self.take(struct.calcsize("<" + form)))[0]
        short = kind == "float32"
        if isinstance(found, float):
            if not math.isfinite(found):
                return "nan" if math.isnan(found) else "inf" if found > 0 else "-inf"
            return float(f"{found:.7g}") if short else found
        if isinstance(found, int) and not isinstance(found, bool) and abs(found) > _SAFE:
            return str(found)
        return found

    def skip(self, kind: str) -> None:
        """Skip a value. Raises BadMessageError after too many, since the rest of the message is then unknown."""
        self.steps += 1
        if self.steps > _MOST_STEPS:
            raise BadMessageError(f"more than {_MOST_STEPS} elements without a fixed size")
        size = self.size_of(kind)
        if size is not None:
            self.take(size)
        elif kind == "string":
            self.take(self.length())
        else:
            for field in self.definition.fields[kind]:
                self.skip_field(field)

    def skip_field(self, field: Field) -> None:
        count = 1 if field.length is None else self.length() if field.length == -1 else field.length
        size = self.size_of(field.kind)
        if size is not None:
            self.take(count * size)
        else:
            for _ in range(count):
                self.skip(field.kind)


def decode(definition: Definition, data: bytes, bounds: Bounds = Bounds()) -> dict[str, Any]:
    """Decode a message: numbers, texts, lists, `Cut`, and dictionaries of these, by field. Raises BadMessageError.

    Numbers that JSON lacks become texts ("nan", "inf"), and so do integers that a browser would round.
    """
    return _Reader(definition, data, bounds).fields(definition.kind)


def read_number(definition: Definition, data: bytes, path: str) -> float | None:
    """The number at a path of a message (FIELD.FIELD); None where there is none, or it is not finite.

    Raises BadMessageError.
    """
    reader = _Reader(definition, data, Bounds())
    kind = definition.kind
    for name in path.split("."):
        for field in definition.fields.get(kind, ()):
            if field.name == name:
                break
            reader.skip_field(field)
        else:
            return None
        if field.length is not None:
            return None
        kind = field.kind
    form = PRIMITIVES.get(kind)
    if form is None:
        return None
    number = float(struct.unpack_from("<" + form, data, reader.take(struct.calcsize("<" + form)))[0])
    return number if math.isfinite(number) else None


def render(values: Mapping[str, object], most: int = 400) -> list[str]:
    """Render values as lines of YAML, at most `most`, each at most 300 characters."""
    lines: list[str] = []
    for line in _render(values, ""):
        if len(lines) >= most:
            lines.append("...")
            break
        lines.append(line[:300])
    return lines


def _render(value: Mapping[str, object], indent: str) -> Iterator[str]:
    for name, found in value.items():
        yield from _render_one(f"{indent}{name}:", found, indent + "  ")


def _render_one(head: str, found: object, indent: str) -> Iterator[str]:
    total = None
    if isinstance(found, Cut):
        total, found = found.total, found.items or []
    if isinstance(found, dict):
        yield head if found else f"{head} {{}}"
        yield from _render(found, indent)
        return
    if not isinstance(found, list):
        yield f"{head} {_text(found)}"
        return
    note = "" if total is None else f"  # the first {len(found)} of {total}"
    if any(isinstance(each, (dict, list, Cut)) for each in found):
        yield head + note
        for number, each in enumerate(found):
            yield from _render_one(f"{indent}[{number}]", each, indent + "  ")
    else:
        yield f"{head} [{', '.join(map(_text, found))}]{note}"


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.9g}" if abs(value) < 1e6 else repr(value)
    return f'"{printable(value)}"' if isinstance(value, str) and value not in ("nan", "inf", "-inf") else str(value)
