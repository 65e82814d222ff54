"""Definitions and uses of the thing at a place."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

from ur.check.rule import LaunchView
from ur.launchfile.world.protocol import PackageNotFound
from ur.lsp.names import NamedThing, expand_everywhere, find_files, find_name_at, find_thing
from ur.lsp.workspace import Workspace
from ur.source.file import SourceFile, Span
from ur.tools.find.arguments import find_argument
from ur.tools.find.occurrences import Kind, Occurrence, WantedName
from ur.tools.find.search import find_resolved

_SAME_KIND: dict[str, Kind] = {"node": "node", "param": "param", "topic": "topic"}


def find_definitions(workspace: Workspace, path: str, offset: int) -> list[Span]:
    """The definitions of the thing at a place."""
    here = find_thing(workspace, path, offset)
    if here is None:
        return []
    view, thing = here
    if thing.kind == "arg":
        return [element.value_span("name") for element in view.declared.get(thing.name, ())]
    if thing.kind == "passed":
        found = (workspace.view(each) for each in included_by(thing, view, workspace))
        return [e.value_span("name") for each in found if each is not None for e in each.declared.get(thing.name, ())]
    if thing.kind == "file":
        return [_top_of(each) for each in find_files(thing.name, view, thing.span.start, workspace)]
    if thing.kind == "package":
        return [_top_of(f"{folder}/package.xml") for folder in find_packages(thing, view, workspace)]
    if thing.kind == "program":
        return [_top_of(each) for each in find_programs(thing, view, workspace)]
    return [each.span for each in _others(thing, view, workspace) if each.defines]


def find_references(workspace: Workspace, path: str, offset: int) -> list[Span]:
    """Every place that speaks of the thing at a place, in the whole workspace, definitions first."""
    here = find_thing(workspace, path, offset)
    if here is None:
        return []
    view, thing = here
    if thing.kind in ("arg", "passed"):
        files = [path] if thing.kind == "arg" else included_by(thing, view, workspace)
        found = [each for file in files for each in find_argument_in(file, thing.name, workspace)]
    elif thing.kind == "file":
        wanted = set(find_files(thing.name, view, thing.span.start, workspace))
        found = [each for each in _file_uses(workspace) if each.name in wanted]
    elif thing.kind == "package":
        found = list(_package_uses(thing.name, workspace))
    else:
        found = list(_others(thing, view, workspace))
    ordered = sorted(found, key=lambda each: (not each.defines, each.span.file.path, each.span.start))
    return list({(each.span.file.path, each.span.start): each.span for each in ordered}.values())


def find_argument_in(path: str, name: str, workspace: Workspace) -> list[Occurrence]:
    """The places of an argument of a file, over the workspace."""
    views = dict(workspace.views)
    if path not in views and (view := workspace.view(path)) is not None:
        views[path] = view
    return list(find_argument(path, name, views, list_programs(workspace))) if path in views else []


def included_by(thing: NamedThing, view: LaunchView, workspace: Workspace) -> list[str]:
    """The files that the `<include>` around a place takes in, in any case."""
    include = thing.place.parents[-1]
    start, end = include.values.get("file", (0, 0))
    return find_files(view.tree.source.text[start:end], view, start, workspace)


def find_packages(thing: NamedThing, view: LaunchView, workspace: Workspace) -> list[str]:
    """The folders of the package that is named."""
    folders = []
    for name in expand_everywhere(thing.name, view, thing.span.start, workspace):
        with suppress(PackageNotFound, OSError, ValueError):
            folders.append(workspace.world.find_package(name))
    return folders


def find_programs(thing: NamedThing, view: LaunchView, workspace: Workspace) -> list[str]:
    """The files that a node's `type` may start."""
    tag = thing.place.tag
    start, end = tag.values.get("pkg", (0, 0)) if tag is not None else (0, 0)
    found: dict[str, None] = {}
    for package in expand_everywhere(view.tree.source.text[start:end], view, start, workspace):
        for name in expand_everywhere(thing.name, view, thing.span.start, workspace):
            with suppress(PackageNotFound, OSError, ValueError):
                found.update(dict.fromkeys(workspace.world.find_executables(package, name)))
    return list(found)


def _others(thing: NamedThing, view: LaunchView, workspace: Workspace) -> Iterator[Occurrence]:
    kind = _SAME_KIND.get(thing.kind)
    if kind is None:
        return
    names = {WantedName(name.lstrip("~")) for name in expand_everywhere(thing.name, view, thing.span.start, workspace)}
    for other in workspace.views.values():
        if not any(name.name.rpartition("/")[2] in other.tree.source.text for name in names):
            continue  # which may be included by what resolves it
        for each in find_resolved(other, workspace.world, frozenset({kind}), follow=False):
            if any(name.matches(each.name) for name in names):
                yield each


def list_programs(workspace: Workspace) -> list[SourceFile]:
    """The programs of the workspace's packages, which may start launch files with arguments."""
    session = workspace.session
    if session is None:
        return []
    paths = session.sources.targets.programs
    return [text for path in paths if (text := session.sources.read_text(path)) is not None]


def _file_uses(workspace: Workspace) -> Iterator[Occurrence]:
    for view in workspace.views.values():
        for _, plan, _ in workspace.cases(view) if "<include" in view.tree.source.text else ():
            for include in plan.includes:
                if not include.origin.includes:
                    yield Occurrence("file", include.file, False, include.origin.span)


def _package_uses(name: str, workspace: Workspace) -> Iterator[Occurrence]:
    for view in workspace.views.values():
        text = view.tree.source.text
        start = text.find(name)
        while start != -1:
            thing = find_name_at(view.tree.source, start)
            if thing is not None and thing.kind == "package" and thing.name == name:
                yield Occurrence("file", name, False, thing.span)
            start = text.find(name, start + len(name))


def _top_of(path: str) -> Span:
    return Span(SourceFile(path, ""), 0, 0)
