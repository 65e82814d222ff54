"""Elements of XML to write, and their text in XML and in YAML, whose values have types."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field

import yaml

from ur.launchfile.ros2.entities import TAGS, VALUE_TYPES
from ur.launchfile.ros2.model import DescriptionProblem
from ur.launchfile.ros2.parameters import coerce
from ur.source.file import SourceFile, Span

_ESCAPES = (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;"), ("\n", "&#10;"), ("\t", "&#9;"))


@dataclass(slots=True)
class XmlTag:
    """An element to write, or a comment where `name` is empty: `comment` is its text."""

    name: str
    attributes: dict[str, str] = field(default_factory=dict)
    children: list[XmlTag] = field(default_factory=list)
    comment: str = ""


def write_xml(root: XmlTag) -> str:
    """The text of an element, with two spaces for each level."""
    return "\n".join(_lines(root, "")) + "\n"


def _lines(tag: XmlTag, indent: str) -> Iterator[str]:
    if not tag.name:
        yield f"{indent}<!--{tag.comment}-->"
        return
    words = [f'{name}="{_escape(value)}"' for name, value in tag.attributes.items()]
    end = ">" if tag.children else "/>"
    line = f"{indent}{' '.join([f'<{tag.name}', *words])}{end}"
    yield line if len(line) <= _WIDTH or len(words) < 2 else _broken(indent + "<" + tag.name, words, indent) + end
    if tag.children:
        for child in tag.children:
            yield from _lines(child, indent + "  ")
        yield f"{indent}</{tag.name}>"


def _broken(start: str, words: Iterable[str], indent: str) -> str:
    first, *others = words
    return f"\n{indent}    ".join([f"{start} {first}", *others])


def _escape(text: str) -> str:
    for character, reference in _ESCAPES:
        text = text.replace(character, reference)
    return text


_WIDTH = 118
_TYPED = ("respawn", "scoped", "forwarding", "allow_substs", "autostart", "shell", "emulate_tty")
_NOWHERE = Span(SourceFile("", ""), 0, 0)


def write_yaml(root: XmlTag) -> str:
    """The text of a whole file. Comments are left out."""
    return yaml.safe_dump({root.name: _children(root.children)}, sort_keys=False, width=_WIDTH, allow_unicode=True)


def _children(tags: list[XmlTag]) -> list[dict[str, object]]:
    return [{tag.name: _entity(tag)} for tag in tags if tag.name]


def _entity(tag: XmlTag) -> object:
    known = TAGS.get(tag.name)
    made: dict[str, object] = {}
    for name, text in tag.attributes.items():
        mode = known.attributes.get(name, ("", ""))[1] if known is not None else ""
        if known is None and name == "value":
            made |= _typed(tag)
        elif known is not None or name not in ("type", "value-sep"):
            made[name] = _read(text, None) if mode in ("flag", "number") or name in _TYPED else text
    inner: list[XmlTag] = []
    for child in tag.children:
        if known is not None and child.name in known.lists:
            made.setdefault(child.name, [])
            made[child.name].append(_entity(child))  # type: ignore[attr-defined]
        else:
            inner.append(child)
    if inner and not made:
        return _children(inner)
    return made | ({"children": _children(inner)} if inner else {})


def _typed(tag: XmlTag) -> Mapping[str, object]:
    """Return the value of a parameter in YAML's own type; with its type where a substitution makes the value."""
    text, name, separator = (tag.attributes.get(each) for each in ("value", "type", "value-sep"))
    text = text or ""
    kind = VALUE_TYPES.get(name)
    if tag.name not in ("param", "extra_arg"):
        return {"value": text}
    if separator:
        item = getattr(kind, "__args__", (kind,))[0]
        return {"value": [_read(part, item) for part in text.split(separator)]}
    if "$(" in text:
        return {"value": text} | ({"type": name} if name else {})
    return {"value": _read(text, kind)}


def _read(text: str, kind: object) -> object:
    with suppress(DescriptionProblem):
        return coerce(text, kind, "", _NOWHERE)
    return text
