"""Includes between launch files, by the paths that `<include>` tags may mean with any arguments."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from ur.check.rule import LaunchView
from ur.check.survey import walk_elements
from ur.launchfile.syntax import Element
from ur.source.file import Span

_PIECE = re.compile(r"\$\([^)]*\)")
_IN_PACKAGE = re.compile(r"\$\(find\s+(\S+)\s*\)/")


@dataclass(frozen=True, slots=True)
class Inclusions:
    """By path of a launch file: the `<include>` tags of other files that may mean it, and the arguments they pass."""

    tags: Mapping[str, tuple[Span, ...]] = field(default_factory=dict)
    passed: Mapping[str, frozenset[str]] = field(default_factory=dict)


def find_inclusions(views: Iterable[LaunchView]) -> Inclusions:
    """Find the includes among launch files."""
    tags: dict[str, list[Span]] = {}
    passed: dict[str, set[str]] = {}
    for view, element, others in _includes(list(views)):
        span = element.value_span("file")
        names = frozenset(_passed_by(element, view)) if others else ()
        for other in others:
            tags.setdefault(other, []).append(span)
            passed.setdefault(other, set()).update(names)
    return Inclusions(
        {path: tuple(spans) for path, spans in tags.items()},
        {path: frozenset(names) for path, names in passed.items()},
    )


def _includes(views: list[LaunchView]) -> Iterator[tuple[LaunchView, Element, list[str]]]:
    # Each <include> with the paths that it may mean, without the file that it stands in.
    paths = [view.path for view in views]
    by_name: dict[str, list[str]] = {}
    for path in paths:
        by_name.setdefault(path.rpartition("/")[2], []).append(path)
    known = frozenset(paths)
    folders: dict[str, set[str]] = {}  # by package
    for view in views:
        if view.package is not None:
            folders.setdefault(view.package.name, set()).add(view.package.folder)
    for view in views:
        for element, _ in walk_elements(view.tree.launch):
            file = element.attributes.get("file", "") if element.name == "include" else ""
            parts = _PIECE.split(file)
            if not any(parts):
                continue  # a path that is only an argument may mean every file, and tells nothing
            package = _IN_PACKAGE.match(file)
            if package and len(parts) == 2 and package.group(1) in folders:
                meant = [f"{folder}{parts[1]}" for folder in folders[package.group(1)]]
                yield view, element, [path for path in meant if path in known and path != view.path]
                continue
            pattern = re.compile(".*".join(map(re.escape, parts)) + r"\Z")
            _, slash, name = parts[-1].rpartition("/")
            candidates = by_name.get(name, []) if slash else paths
            yield (
                view,
                element,
                [
                    path
                    for path in candidates
                    if path != view.path and path.endswith(parts[-1]) and pattern.search(path)
                ],
            )


def _passed_by(include: Element, view: LaunchView) -> Iterator[str]:
    for child in include.elements:
        if child.name == "arg" and child.attributes.get("name"):
            yield child.attributes["name"]
    if include.attributes.get("pass_all_args", "false").lower() != "false":
        yield from view.declared
