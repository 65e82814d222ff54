"""Proof that a formatted file means what it meant: trees and plans compared."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

from ur.check.cases import resolve_cases
from ur.check.model import Package
from ur.check.survey import survey_launch_file
from ur.check.worlds import CachedWorld
from ur.format.order import is_title
from ur.launchfile.plan.model import Origin, Plan
from ur.launchfile.syntax import Comment, Element, LaunchFile
from ur.launchfile.world import World


class EditedWorld:
    """A world in which one file says something else."""

    def __init__(self, world: World, path: str, data: bytes) -> None:
        self._world = world
        self._path = path
        self._data = data

    def read_bytes(self, path: str) -> bytes:
        """See World."""
        return self._data if self._world.absolute(path) == self._path else self._world.read_bytes(path)

    @property
    def environment(self) -> Mapping[str, str]:
        """See World."""
        return self._world.environment

    def __getattr__(self, name: str) -> Any:
        return getattr(self._world, name)


def same_content(before: LaunchFile, after: LaunchFile) -> bool:
    """Return whether two files hold the same tags, comments and texts; those directly in `<launch>` in whatever order.

    Comments that title a group of arguments do not count, nor blanks in comments.
    """
    first, second = before.root, after.root
    if first is None or second is None:
        return first is second
    return (
        (first.name, first.attributes) == (second.name, second.attributes)
        and Counter(map(_content, _told(first))) == Counter(map(_content, _told(second)))
        and [_content(each) for each in before.comments] == [_content(each) for each in after.comments]
    )


def same_plans(path: str, data: bytes, new: bytes, package: Package | None, world: World) -> bool:
    """Return whether a launch file resolves to the same plans, for each base, variant and option."""
    before = _plans(path, package, EditedWorld(world, path, data))
    after = _plans(path, package, EditedWorld(world, path, new))
    return all(first == second for first, second in zip(before, after, strict=True))


def _plans(path: str, package: Package | None, world: World) -> Iterator[object]:
    cached = CachedWorld(world)
    for resolved in resolve_cases(survey_launch_file(path, package, cached), cached):
        yield resolved.case, _meaning(resolved.plan)


def _meaning(plan: Plan) -> object:
    said = Counter((found.severity, found.rule, found.message) for found in plan.diagnostics)
    return said, [
        _plain(getattr(plan, field.name)) for field in fields(plan) if field.name not in ("diagnostics", "files")
    ]


def _plain(value: object) -> object:
    """A value of a plan without the places it came from."""
    if is_dataclass(value) and not isinstance(value, type):
        return [_plain(getattr(value, f.name)) for f in fields(value) if not isinstance(getattr(value, f.name), Origin)]
    if isinstance(value, tuple | list):
        return [_plain(each) for each in value]
    return repr(value) if isinstance(value, float) else value


def _told(element: Element) -> Iterable[Element | Comment]:
    return (each for each in element.children if not (isinstance(each, Comment) and is_title(each.span.text)))


def _content(each: Element | Comment) -> object:
    if isinstance(each, Comment):
        return " ".join(each.text.split())
    inside = tuple(_content(child) for child in each.children)
    return each.name, tuple(sorted(each.attributes.items())), each.text, inside
