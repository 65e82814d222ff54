"""The syntax tree of a launch file: elements, attributes and comments, each with its exact position.

Offsets are characters in the text of the file. Positions inside a tag are computed on request, mostly to report errors.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ur.source.diagnostic import Diagnostic
from ur.source.file import SourceFile, Span

WRONG_LAUNCHER = "wrong-ros-version"
_ATTRIBUTE = re.compile(r"""\s+([^\s=>/"']+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
_REFERENCE = re.compile(r"&[^;]{0,60};|\r\n")
_TEXT_PART = re.compile(
    r"<!--.*?(?:-->|\Z)|<!\[CDATA\[(.*?)(?:\]\]>|\Z)|<\?.*?(?:\?>|\Z)|<[^>]*(?:>|\Z)|[^<]+", re.DOTALL
)


class Comment(NamedTuple):
    """A comment. `text` is the text between the dashes."""

    span: Span
    text: str


class Element:
    """A tag with its attributes and contents. Not to be changed once the file is parsed.

    `attributes` has the normalised XML values (references replaced, line breaks turned into spaces), in the order of
    the file. `text` is the character data directly inside, collected for `<rosparam>` only.
    """

    __slots__ = ("_pieces", "_places", "attributes", "children", "end", "name", "source", "start", "text")

    def __init__(self, source: SourceFile, name: str, attributes: dict[str, str], start: int) -> None:
        self.source = source
        self.name = name
        self.attributes = attributes
        self.start = start
        self.end = start  # where the end tag starts; for an empty element where the element starts
        self.children: Sequence[Element | Comment] = ()
        self.text = ""
        self._places: dict[str, tuple[int, int, int, int]] | None = None
        self._pieces: list[_Piece] | None = None

    def __repr__(self) -> str:
        return f"<{self.name}> at {self.span}"

    def add_child(self, child: Element | Comment) -> None:
        """Add a child; for the parser only."""
        if type(self.children) is list:
            self.children.append(child)
        else:
            self.children = [child]  # most elements have no children: they share an empty tuple

    @property
    def span(self) -> Span:
        """The opening `<name`."""
        return Span(self.source, self.start, self.start + 1 + len(self.name))

    @property
    def tag_span(self) -> Span:
        """The whole start tag."""
        return Span(self.source, self.start, self._tag_end())

    @property
    def elements(self) -> Iterator[Element]:
        """The elements directly inside."""
        return (child for child in self.children if type(child) is Element)

    @property
    def comments(self) -> Iterator[Comment]:
        """The comments directly inside."""
        return (child for child in self.children if type(child) is Comment)

    def name_span(self, attribute: str) -> Span:
        """Return the span of an attribute's name; of the element if the attribute is missing."""
        place = self._find_places().get(attribute)
        return Span(self.source, place[0], place[1]) if place else self.span

    def value_span(self, attribute: str) -> Span:
        """Return the span of an attribute's value without its quotes; of the element if the attribute is missing."""
        place = self._find_places().get(attribute)
        return Span(self.source, place[2], place[3]) if place else self.span

    def piece_span(self, attribute: str, start: int, end: int) -> Span:
        """Return the span of characters `start` to `end` of an attribute's value in the file.

        The value differs from the text in the file by the references (`&lt;`) in it.
        """
        whole = self.value_span(attribute)
        raw = whole.text
        if not ("&" in raw or "\r" in raw):
            return Span(self.source, min(whole.start + start, whole.end), min(whole.start + end, whole.end))
        place = written_offsets(raw)
        return Span(self.source, whole.start + place(start), whole.start + place(end))

    def text_offset(self, offset: int) -> int:
        """Return the offset in the file of a character of `text`."""
        if self._pieces is None:
            self._pieces = list(self._find_pieces())
        index = bisect_left(self._pieces, offset, key=lambda piece: piece.end)
        if index == len(self._pieces):
            return self._tag_end()
        piece = self._pieces[index]
        return piece.start + piece.place(offset - (self._pieces[index - 1].end if index else 0))

    def _find_pieces(self) -> Iterator[_Piece]:
        position = self._tag_end()
        passed = 0
        depth = 0
        for part in _TEXT_PART.finditer(self.source.text, position, max(position, self.end)):
            raw = part.group()
            if raw.startswith("<![CDATA["):
                if not depth:
                    passed += len(part.group(1))
                    yield _Piece(passed, part.start(1), written_offsets(""))
            elif raw.startswith("</"):
                depth -= 1
            elif raw.startswith("<"):
                depth += raw[1] not in "!?" and not raw.endswith("/>")
            elif not depth:
                passed += len(_REFERENCE.sub("x", raw))
                yield _Piece(passed, part.start(), written_offsets(raw))

    def _tag_end(self) -> int:
        text = self.source.text
        position = self.start + 1 + len(self.name)
        while True:
            match = _ATTRIBUTE.match(text, position)
            if match is None:
                close = text.find(">", position)
                return close + 1 if close != -1 else len(text)
            position = match.end()

    def _find_places(self) -> dict[str, tuple[int, int, int, int]]:
        if self._places is None:
            self._places = {}
            position = self.start + 1 + len(self.name)
            while True:
                match = _ATTRIBUTE.match(self.source.text, position)
                if match is None:
                    break
                group = 2 if match.group(2) is not None else 3
                self._places[match.group(1)] = (*match.span(1), *match.span(group))
                position = match.end()
        return self._places


class written_offsets:  # noqa: N801 - used like a function: written_offsets(raw)(offset)
    """Maps offsets in a normalised XML value to offsets in its raw text."""

    __slots__ = ("_steps",)

    def __init__(self, raw: str) -> None:
        shrunk = 0
        self._steps: list[tuple[int, int]] = []  # (first offset after a reference, characters saved so far)
        for match in _REFERENCE.finditer(raw):
            shrunk += match.end() - match.start() - 1
            self._steps.append((match.end() - shrunk, shrunk))

    def __call__(self, offset: int) -> int:
        """Return the raw offset of a character of the value."""
        index = bisect_right(self._steps, offset, key=lambda step: step[0])
        return offset + (self._steps[index - 1][1] if index else 0)


class _Piece(NamedTuple):
    end: int  # of this piece, in the text
    start: int  # in the file
    place: written_offsets  # from offsets in the piece to those in the file


class LaunchFile(NamedTuple):
    """A parsed file. `launch` is the only `<launch>` element; None if there is none, or more than one.

    With an error in `diagnostics`, the tree contains the elements before it.
    """

    source: SourceFile
    root: Element | None
    launch: Element | None
    comments: tuple[Comment, ...]  # those outside of the root element
    diagnostics: tuple[Diagnostic, ...]

    @property
    def for_other_launcher(self) -> bool:
        """True if the file is written for another launcher than roslaunch."""
        return any(found.rule == WRONG_LAUNCHER for found in self.diagnostics)
