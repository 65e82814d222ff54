"""A launch file as pieces for the layout: tags with their attributes as written, comments, and everything else."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from ur.launchfile.syntax import Comment, Element

_ATTRIBUTE = re.compile(r"""\s+([^\s=>/"']+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
_OTHER = re.compile(r"(?<!\s)(\s*)(<!\[CDATA\[.*?(?:\]\]>|\Z)|<\?.*?(?:\?>|\Z)|[^\s<](?:[^<]*[^\s<])?)", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Tag:
    """An element.

    `attributes` are name and value with its quotes, both as written; `verbatim` is its content if no character of it
    may change (the YAML of a `<rosparam>`).
    """

    name: str
    attributes: tuple[tuple[str, str], ...]
    inside: tuple[Piece, ...] = ()
    verbatim: str | None = None
    element: Element | None = None


@dataclass(frozen=True, slots=True)
class CommentPiece:
    """A comment, from `<!--` to `-->`. `column` is the indentation of its first line; None after other content."""

    text: str
    column: int | None


@dataclass(frozen=True, slots=True)
class Other:
    """Content that roslaunch ignores, and that is kept: stray text, processing instructions."""

    text: str


@dataclass(frozen=True, slots=True)
class Piece:
    """A piece in its context: whether a blank line precedes it, and whether it continues the previous line."""

    what: Tag | CommentPiece | Other
    blank_before: bool = False
    same_line: bool = False


def read_pieces(root: Element) -> Tag:
    """Return the pieces of an element that was parsed without errors."""
    whole = root.source.text
    tag = root.tag_span
    attributes = tuple(_attributes(tag.text, len(root.name) + 1))
    if tag.text.endswith("/>") or root.end <= root.start:
        return Tag(root.name, attributes, element=root)
    content = whole[tag.end : root.end]
    if root.name.lower() == "rosparam" and content:
        return Tag(root.name, attributes, verbatim=content, element=root)
    return Tag(root.name, attributes, tuple(_inside(root, tag.end)), element=root)


def make_note(text: str, before: str) -> CommentPiece:
    """Return a comment; `before` is the text before it."""
    line = before.rpartition("\n")[2]
    return CommentPiece(text, None if line.strip() else len(line.expandtabs(4)))


def _attributes(tag: str, position: int) -> Iterator[tuple[str, str]]:
    while match := _ATTRIBUTE.match(tag, position):
        double = match.group(2)
        value = match.group(3) if double is None else double
        yield match.group(1), f"'{value}'" if '"' in value else f'"{value}"'
        position = match.end()


def _inside(root: Element, position: int) -> Iterator[Piece]:
    whole = root.source.text
    for child in root.children:
        start = child.span.start
        yield from _others(whole[position:start])
        gap = whole[len(whole[:start].rstrip()) : start]
        what = make_note(child.span.text, whole[:start]) if isinstance(child, Comment) else read_pieces(child)
        yield Piece(what, gap.count("\n") > 1, "\n" not in gap)
        position = child.span.end if isinstance(child, Comment) else end_of(child)
    yield from _others(whole[position : root.end])


def _others(gap: str) -> Iterator[Piece]:
    for match in _OTHER.finditer(gap):
        yield Piece(Other(match.group(2)), match.group(1).count("\n") > 1)


def end_of(element: Element) -> int:
    """Return the offset of the end of an element, its end tag included."""
    tag = element.tag_span
    if tag.text.endswith("/>") or element.end <= element.start:
        return tag.end
    return element.source.text.index(">", element.end) + 1
