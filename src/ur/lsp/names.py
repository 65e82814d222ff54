"""The thing at a place of a launch file: an argument, file, package, program, node, parameter or topic."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from ur.check.rule import LaunchView
from ur.check.worlds import has_marker
from ur.launchfile.plan.problems import TagRefused
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.specs import ArgumentStep
from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.plan.values.substitute import substitute
from ur.launchfile.syntax import SubstitutionProblem
from ur.lsp.cursor import CursorPosition, find_cursor
from ur.lsp.workspace import ResolvedCase, Workspace
from ur.source.file import SourceFile, Span

NameKind = Literal["arg", "passed", "file", "package", "program", "node", "param", "topic", "tag", "attribute"]
_PIECE = re.compile(r"\$\(\s*(?P<command>\w*)(?P<rest>[^)$]*)\)?")
_WORD = re.compile(r"[A-Za-z_][\w./-]*")
_KINDS: dict[tuple[str, str], NameKind] = {
    ("include", "file"): "file",
    ("rosparam", "file"): "file",
    ("param", "textfile"): "file",
    ("param", "binfile"): "file",
    ("node", "pkg"): "package",
    ("test", "pkg"): "package",
    ("node", "type"): "program",
    ("test", "type"): "program",
    ("node", "name"): "node",
    ("test", "name"): "node",
    ("param", "name"): "param",
    ("rosparam", "param"): "param",
    ("remap", "from"): "topic",
    ("remap", "to"): "topic",
    ("arg", "name"): "arg",
}


@dataclass(frozen=True, slots=True)
class NamedThing:
    """A name at a place, as it is written."""

    kind: NameKind
    name: str
    span: Span
    cursor: CursorPosition


def find_name_at(source: SourceFile, offset: int) -> NamedThing | None:
    """The name at an offset of a launch file; None in comments and elsewhere."""
    place = find_cursor(source.text, offset)
    if place.tag is None:
        return None
    if place.kind == "tag":
        return NamedThing("tag", place.tag.name, Span(source, place.start, place.end), place)
    if place.kind == "attribute" and place.end > place.start:
        return NamedThing(
            "attribute", source.text[place.start : place.end], Span(source, place.start, place.end), place
        )
    if place.kind != "value":
        return None
    return _in_substitution(source, offset, place) or _in_value(source, place)


def find_thing(workspace: Workspace, path: str, offset: int) -> tuple[LaunchView, NamedThing] | None:
    """A launch file and the name at an offset of it; None where there is neither."""
    view = workspace.view(path)
    thing = find_name_at(view.tree.source, offset) if view is not None else None
    return (view, thing) if view is not None and thing is not None else None


def _in_substitution(source: SourceFile, offset: int, cursor: CursorPosition) -> NamedThing | None:
    value = source.text[cursor.start : cursor.end]
    if value.startswith("$(eval "):
        words = _words(source, cursor.start + len("$(eval "), cursor.end)
        return next(
            (NamedThing("arg", each.text, each, cursor) for each in words if each.start <= offset <= each.end), None
        )
    for piece in _PIECE.finditer(value):
        if not cursor.start + piece.start() < offset <= cursor.start + piece.end():
            continue
        kinds: dict[str, NameKind] = {"arg": "arg", "find": "package"}
        kind = kinds.get(piece.group("command"))
        start, end = (cursor.start + each for each in piece.span("rest"))
        word = next(iter(_words(source, start, end)), None)
        return NamedThing(kind, word.text, word, cursor) if kind is not None and word is not None else None
    return None


def _words(source: SourceFile, start: int, end: int) -> Iterator[Span]:
    return (Span(source, *match.span()) for match in _WORD.finditer(source.text, start, end))


def _in_value(source: SourceFile, cursor: CursorPosition) -> NamedThing | None:
    assert cursor.tag is not None
    span = Span(source, cursor.start, cursor.end)
    kind = _KINDS.get((cursor.tag.name, cursor.attribute))
    if kind == "arg" and cursor.inside == "include":
        kind = "passed"
    if kind is None and "/" in span.text and ("$(find" in span.text or "$(dirname)" in span.text):
        kind = "file"
    return NamedThing(kind, span.text, span, cursor) if kind is not None and span.text else None


def arguments_before(case: ResolvedCase, view: LaunchView, offset: int) -> dict[str, str]:
    """The values that arguments of a file have at an offset, where no other file includes it."""
    return {
        step.name: step.value
        for step in case[2]
        if isinstance(step, ArgumentStep)
        and step.passed_to is None
        and step.value is not None
        and not step.origin.includes
        and step.origin.span.file.path == view.path
        and step.origin.span.start <= offset
    }


def expand(value: str, arguments: dict[str, str], path: str, workspace: Workspace) -> str | None:
    """A value with its `$(...)` replaced; None where it cannot be known."""
    if "$" not in value:
        return value
    world = workspace.world.seen_from(path.rpartition("/")[0], workspace.world.environment)
    try:
        found = substitute(value, Scope("/", path, arguments), world, Budget())
    except (SubstitutionProblem, TagRefused, OSError, ValueError, RecursionError):
        return None
    return None if has_marker(found) else found


def expand_everywhere(value: str, view: LaunchView, offset: int, workspace: Workspace) -> dict[str, str]:
    """The results of a value, each with the cases that it has it in."""
    found: dict[str, list[str]] = {}
    for case in workspace.cases(view):
        result = expand(value, arguments_before(case, view, offset), view.path, workspace)
        if result is not None:
            found.setdefault(result, []).append(case[0])
    return {result: ", ".join(filter(None, labels)) for result, labels in found.items()}


def find_files(value: str, view: LaunchView, offset: int, workspace: Workspace) -> list[str]:
    """The files that a value names, in any case, and that exist."""
    world = workspace.world.seen_from(view.path.rpartition("/")[0], workspace.world.environment)
    found = (world.locate(path) for path in expand_everywhere(value, view, offset, workspace) if path)
    return [path for path in dict.fromkeys(found) if world.is_file(path)]
