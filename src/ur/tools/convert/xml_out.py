"""Elements of the XML to write, and their text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

_WIDTH = 118
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
