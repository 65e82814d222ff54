"""Launch files, read once, and their properties that rules use."""

import re
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property

from ur.launchfile.syntax import (
    Element,
    LaunchFile,
    SubstitutionProblem,
    is_eval,
    parse_launch_file,
    parse_substitutions,
)
from ur.source.file import Span

_WORD = re.compile(r"[A-Za-z_]\w*")
_OTHER_COMMANDS = frozenset({"find", "env", "optenv", "dirname", "anon"})


class LaunchSurvey:
    """The tree of a launch file and its properties, each computed on first use.

    A check with stored findings of the file never computes them.
    """

    def __init__(self, path: str, data: bytes, read: Callable[[str], bytes]) -> None:
        self._path, self._data, self._read = path, data, read

    @cached_property
    def tree(self) -> LaunchFile:
        """The syntax tree."""
        return parse_launch_file(self._path, self._data, self._read)

    @cached_property
    def declared(self) -> Mapping[str, tuple[Element, ...]]:
        declared: dict[str, list[Element]] = {}
        for element, parent in walk_elements(self.tree.launch):
            name = element.attributes.get("name")
            if element.name == "arg" and name and (parent is None or parent.name != "include"):
                declared.setdefault(name, []).append(element)
        return {name: tuple(elements) for name, elements in declared.items()}

    @cached_property
    def used(self) -> Mapping[str, tuple[Span, ...]]:
        used: dict[str, list[Span]] = {}
        for element, _ in walk_elements(self.tree.launch):
            for argument, span in find_uses(element):
                used.setdefault(argument, []).append(span)
        return {name: tuple(spans) for name, spans in used.items()}


def walk_elements(top: Element | None) -> Iterator[tuple[Element, Element | None]]:
    """Yield every element below `top` in document order, with its parent."""
    stack: list[tuple[Element, Element | None]] = [(top, None)] if top is not None else []
    while stack:
        element, parent = stack.pop()
        yield element, parent
        stack.extend((child, element) for child in reversed(list(element.elements)))


def walk_possible(top: Element | None) -> Iterator[Element]:
    """Yield elements as `walk_elements`, without those that a literal `if="false"` or `unless="true"` disables."""
    stack = [top] if top is not None else []
    while stack:
        element = stack.pop()
        if not is_switched_off(element):
            yield element
            stack.extend(reversed(list(element.elements)))


def is_switched_off(element: Element) -> bool:
    """Return whether a tag is disabled for all arguments."""
    condition = element.attributes.get("if", "true").strip().lower()
    exception = element.attributes.get("unless", "false").strip().lower()
    return condition in ("false", "0") or exception in ("true", "1")


def find_uses(element: Element) -> Iterator[tuple[str, Span]]:
    """Yield the arguments that an element's attributes and text refer to, each with its position."""
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
    except SubstitutionProblem:  # reported where it is resolved; its readable parts still count as used
        yield from ((match.group(), match.start(), match.end()) for match in _WORD.finditer(value))
        return
    for piece in pieces:
        if is_eval(value):
            for match in _WORD.finditer(piece.content):
                offset = piece.start + len("$(eval ")
                yield match.group(), offset + match.start(), offset + match.end()
        # A misspelt command, which is reported elsewhere, probably uses an argument
        elif piece.command not in _OTHER_COMMANDS:
            yield from ((word.text, word.start, word.end) for word in piece.words)
