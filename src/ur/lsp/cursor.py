"""The place of a cursor in a text that may be half typed: the tag, attribute or value around it."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

CandidateKind = Literal["tag", "attribute", "package", "program", "file", "folder", "argument", "value", "rule"]

_TOKEN = re.compile(
    r"<!--.*?(?:-->|\Z)|<!\[CDATA\[.*?(?:\]\]>|\Z)|<[?!][^>]*(?:>|\Z)"
    r"""|<(?P<close>/?)(?P<name>[^\s<>/="']*)(?P<rest>(?:"[^"<]*"?|'[^'<]*'?|[^<>"'/]|/(?!>))*)(?P<end>/?>)?""",
    re.DOTALL,
)
_ATTRIBUTE = re.compile(r"""([^\s=<>"'/]+)(?:\s*=\s*(?:"([^"<]*)("?)|'([^'<]*)('?))?)?""")


@dataclass(frozen=True, slots=True)
class OpenTag:
    """A start tag as it is written so far. `values` are spans in the text, without quotes."""

    name: str
    start: int
    values: Mapping[str, tuple[int, int]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class CursorPosition:
    """A place: `begin` is what is typed before the cursor, from `start` on, up to which `end` it would be replaced.

    `parents` are the open tags around it, outermost first.
    """

    kind: Literal["text", "comment", "tag", "attribute", "value"]
    begin: str
    start: int
    end: int
    tag: OpenTag | None = None
    attribute: str = ""
    parents: tuple[OpenTag, ...] = ()

    @property
    def inside(self) -> str:
        """The name of the innermost open tag."""
        return self.parents[-1].name if self.parents else ""


def find_cursor(text: str, offset: int) -> CursorPosition:
    """The place of an offset in a launch file. Never raises."""
    parents: list[OpenTag] = []
    for token in _TOKEN.finditer(text):
        if token.start() >= offset:
            break
        inside = offset < token.end() or (offset == token.end() and not text[: token.end()].endswith(">"))
        if token.group("name") is None:
            if inside:
                return CursorPosition(
                    "comment", text[token.start() : offset], token.start(), token.end(), None, "", (*parents,)
                )
            continue
        if inside:
            return _in_tag(text, offset, token, tuple(parents))
        if token.group("close"):
            index = next((n for n in reversed(range(len(parents))) if parents[n].name == token.group("name")), None)
            del parents[index if index is not None else len(parents) :]
        elif token.group("end") != "/>":
            parents.append(_tag(text, token))
    start = offset
    while start > 0 and (text[start - 1].isalnum() or text[start - 1] in "_-"):
        start -= 1
    return CursorPosition("text", text[start:offset], start, offset, None, "", tuple(parents))


def _tag(text: str, token: re.Match[str]) -> OpenTag:
    found = _ATTRIBUTE.finditer(text, token.start("rest"), token.end("rest"))
    values = {each.group(1): each.span(2 if each.group(2) is not None else 4) for each in found}
    return OpenTag(token.group("name"), token.start(), {name: span for name, span in values.items() if span[0] >= 0})


def _in_tag(text: str, offset: int, token: re.Match[str], parents: tuple[OpenTag, ...]) -> CursorPosition:
    tag = _tag(text, token)
    if offset <= token.end("name"):
        begin = token.start("name")
        return CursorPosition("tag", text[begin:offset], min(begin, offset), token.end("name"), tag, "", parents)
    for each in _ATTRIBUTE.finditer(text, token.start("rest"), token.end("rest")):
        if not each.start() <= offset <= each.end():
            continue
        if offset <= each.end(1):
            return CursorPosition("attribute", text[each.start() : offset], each.start(), each.end(1), tag, "", parents)
        start, end = each.span(2 if each.group(2) is not None else 4)
        if 0 <= start <= offset <= end:
            return CursorPosition("value", text[start:offset], start, end, tag, each.group(1), parents)
    return CursorPosition("attribute", "", offset, offset, tag, "", parents)


@dataclass(frozen=True, slots=True)
class Candidate:
    """Something to insert between two offsets. `more`: another candidate may follow at once."""

    label: str
    kind: CandidateKind
    insert: str
    start: int
    end: int
    help: str = ""
    document: str = ""
    more: bool = False
