"""Includes between launch files, by the paths that `<include>` tags may mean whatever their arguments are."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from ur.check.model import LaunchView
from ur.check.survey import walk_elements
from ur.launchfile.syntax import Element
from ur.source.file import Span

_PIECE = re.compile(r"\$\([^)]*\)")


@dataclass(frozen=True, slots=True)
class Inclusions:
    """By path of a launch file: the `<include>` tags of other files that may mean it, and the arguments they pass."""

    tags: Mapping[str, tuple[Span, ...]] = field(default_factory=dict)
    passed: Mapping[str, frozenset[str]] = field(default_factory=dict)


def find_inclusions(views: Iterable[LaunchView]) -> Inclusions:
    """Find the includes among launch files."""
    tags: dict[str, list[Span]] = {}
    passed: dict[str, set[str]] = {}
    for view, element, other in _pairs(list(views)):
        tags.setdefault(other.path, []).append(element.value_span("file"))
        passed.setdefault(other.path, set()).update(_passed_by(element, view))
    return Inclusions(
        {path: tuple(spans) for path, spans in tags.items()},
        {path: frozenset(names) for path, names in passed.items()},
    )


def _pairs(views: list[LaunchView]) -> Iterator[tuple[LaunchView, Element, LaunchView]]:
    by_name: dict[str, list[LaunchView]] = {}
    for view in views:
        by_name.setdefault(view.path.rpartition("/")[2], []).append(view)
    for view in views:
        for element, _ in walk_elements(view.tree.launch):
            file = element.attributes.get("file", "") if element.name == "include" else ""
            parts = _PIECE.split(file)
            if not any(parts):
                continue  # a path that is only an argument may mean every file, and tells nothing
            pattern = re.compile(".*".join(map(re.escape, parts)) + r"\Z")
            _, slash, name = parts[-1].rpartition("/")
            for other in by_name.get(name, []) if slash else views:
                if other is not view and other.path.endswith(parts[-1]) and pattern.search(other.path):
                    yield view, element, other


def _passed_by(include: Element, view: LaunchView) -> Iterator[str]:
    for child in include.elements:
        if child.name == "arg" and child.attributes.get("name"):
            yield child.attributes["name"]
    if include.attributes.get("pass_all_args", "false").lower() != "false":
        yield from view.declared
