"""Reading launch files once, and noting what their rules ask for."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from ur.check.rule import LaunchView, Package
from ur.launchfile.syntax import (
    Element,
    LaunchFile,
    SubstitutionProblem,
    is_eval,
    parse_launch_file,
    parse_substitutions,
)
from ur.launchfile.world import World
from ur.source.file import Span

_WORD = re.compile(r"[A-Za-z_]\w*")
_OTHER_COMMANDS = frozenset({"find", "env", "optenv", "dirname", "anon"})


def survey_launch_file(path: str, package: Package | None, world: World, tree: LaunchFile | None = None) -> LaunchView:
    """A launch file and the arguments it declares and uses; `tree` where it is parsed already. Raises OSError."""
    tree = parse_launch_file(path, world.read_bytes(path)) if tree is None else tree
    declared: dict[str, list[Element]] = {}
    for element, parent in walk_elements(tree.launch):
        name = element.attributes.get("name")
        if element.name == "arg" and name and (parent is None or parent.name != "include"):
            declared.setdefault(name, []).append(element)
    return LaunchView(
        path,
        tree,
        package,
        {name: tuple(elements) for name, elements in declared.items()},
        ArgumentUses(tree),
        world,
    )


class ArgumentUses(Mapping[str, tuple[Span, ...]]):
    """The places that speak of arguments, by name; looked for when the first is asked for.

    A check that recalls the findings of a file never asks.
    """

    def __init__(self, tree: LaunchFile) -> None:
        self._tree = tree
        self._found: dict[str, tuple[Span, ...]] | None = None

    def _find(self) -> dict[str, tuple[Span, ...]]:
        if self._found is None:
            used: dict[str, list[Span]] = {}
            for element, _ in walk_elements(self._tree.launch):
                for argument, span in find_uses(element):
                    used.setdefault(argument, []).append(span)
            self._found = {name: tuple(spans) for name, spans in used.items()}
        return self._found

    def __getitem__(self, name: str) -> tuple[Span, ...]:
        return self._find()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._find())

    def __len__(self) -> int:
        return len(self._find())


def walk_elements(top: Element | None) -> Iterator[tuple[Element, Element | None]]:
    """Every element below `top` in document order, with the one it stands in."""
    stack: list[tuple[Element, Element | None]] = [(top, None)] if top is not None else []
    while stack:
        element, parent = stack.pop()
        yield element, parent
        stack.extend((child, element) for child in reversed(list(element.elements)))


def walk_possible(top: Element | None) -> Iterator[Element]:
    """As walk_elements, without what a plain `if="false"` or `unless="true"` switches off for good."""
    stack = [top] if top is not None else []
    while stack:
        element = stack.pop()
        if not is_switched_off(element):
            yield element
            stack.extend(reversed(list(element.elements)))


def is_switched_off(element: Element) -> bool:
    """Return whether a tag never takes part, with any arguments."""
    condition = element.attributes.get("if", "true").strip().lower()
    exception = element.attributes.get("unless", "false").strip().lower()
    return condition in ("false", "0") or exception in ("true", "1")


def find_uses(element: Element) -> Iterator[tuple[str, Span]]:
    """The arguments that an element's attributes and text speak of, each with its place."""
    for attribute, value in element.attributes.items():
        if "$(" in value:
            for name, start, end in _names_in(value):
                yield name, element.piece_span(attribute, start, end)
    if "$(" in element.text:
        for name, start, end in _names_in(element.text):
            yield name, Span(element.source, element.text_offset(start), element.text_offset(end))


def _names_in(value: str) -> Iterator[tuple[str, int, int]]:
    try:
        pieces = parse_substitutions(value)
    except SubstitutionProblem:  # reported where it is resolved; what can be read of it still counts as used
        yield from ((match.group(), match.start(), match.end()) for match in _WORD.finditer(value))
        return
    for piece in pieces:
        if is_eval(value):
            for match in _WORD.finditer(piece.content):
                offset = piece.start + len("$(eval ")
                yield match.group(), offset + match.start(), offset + match.end()
        elif piece.command not in _OTHER_COMMANDS:  # a misspelt command, reported elsewhere, was meant to use something
            yield from ((word.text, word.start, word.end) for word in piece.words)
