"""The things that launch files define, what can be folded, and the files that include one another."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from ur.check.rule import LaunchView
from ur.check.survey import walk_elements
from ur.launchfile.syntax import Comment, Element
from ur.lsp.workspace import Workspace
from ur.source.file import Span

SymbolKind = Literal["argument", "node", "include", "group", "param", "remap", "machine", "file", "env"]
_KINDS: dict[str, SymbolKind] = {
    "arg": "argument",
    "node": "node",
    "test": "node",
    "include": "include",
    "group": "group",
    "param": "param",
    "rosparam": "param",
    "remap": "remap",
    "machine": "machine",
    "env": "env",
}
_NAMES = ("name", "test-name", "file", "ns", "from", "param")
_MOST = 500


@dataclass(frozen=True, slots=True)
class Symbol:
    """Something that a file defines: all of it, the part that names it, and its contents."""

    name: str
    kind: SymbolKind
    detail: str
    whole: Span
    named: Span
    inside: tuple[Symbol, ...] = ()


@dataclass(frozen=True, slots=True)
class Fold:
    """Lines that may be folded into their first one, counted from 1."""

    first: int
    last: int
    comment: bool = False


def outline(view: LaunchView) -> tuple[Symbol, ...]:
    """The symbols of a file in document order."""
    return tuple(_below(view.tree.launch)) if view.tree.launch is not None else ()


def _below(element: Element) -> Iterator[Symbol]:
    for child in element.elements:
        kind = _KINDS.get(child.name)
        if kind is not None:
            yield _symbol(child, kind)


def _symbol(element: Element, kind: SymbolKind) -> Symbol:
    attribute = next((name for name in _NAMES if element.attributes.get(name)), "")
    name = element.attributes.get(attribute, "") or element.name
    detail = {
        "node": f"{element.attributes.get('pkg', '')}/{element.attributes.get('type', '')}",
        "argument": element.attributes.get("default") or element.attributes.get("value") or "",
        "param": element.attributes.get("value") or "",
        "remap": element.attributes.get("to") or "",
    }.get(kind, "")
    named = element.value_span(attribute) if attribute else element.span
    return Symbol(name, kind, detail, whole_of(element), named, tuple(_below(element)))


def whole_of(element: Element) -> Span:
    """A tag from its beginning to the end of its end tag."""
    opening = element.tag_span
    if element.end <= element.start or opening.text.endswith("/>"):
        return opening
    close = element.source.text.find(">", element.end)
    return Span(element.source, element.start, close + 1 if close != -1 else len(element.source.text))


def list_symbols(workspace: Workspace, query: str) -> list[Symbol]:
    """The symbols of all launch files whose names hold the letters of a query in their order."""
    found = []
    for view in workspace.views.values():
        waiting = list(outline(view))
        while waiting:
            symbol = waiting.pop(0)
            waiting.extend(symbol.inside)
            if symbol.kind != "group" and _fits(query.lower(), symbol.name.lower()):
                found.append(symbol)
    found.sort(key=lambda each: (query.lower() not in each.name.lower(), len(each.name), each.name))
    return found[:_MOST]


def _fits(query: str, name: str) -> bool:
    letters = iter(name)
    return all(letter in letters for letter in query)


def list_folds(view: LaunchView) -> list[Fold]:
    """Tags and comments of more than a line."""
    folds = []
    comments: list[Comment] = list(view.tree.comments)
    for element, _ in walk_elements(view.tree.root):
        comments.extend(element.comments)
        span = whole_of(element)
        first, last = span.position.line, span.file.position(span.end).line
        closes = not element.tag_span.text.endswith("/>")
        if last - first > int(closes):
            folds.append(Fold(first, last - 1 if closes else last))
    for comment in comments:
        first, last = comment.span.position.line, comment.span.file.position(comment.span.end).line
        if last > first:
            folds.append(Fold(first, last, comment=True))
    return sorted(folds, key=lambda each: (each.first, each.last))
