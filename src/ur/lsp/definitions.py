"""Definitions and uses of the thing at a place."""

from collections.abc import Iterator
from contextlib import suppress

from ur.check.rule import LaunchView
from ur.launchfile.world.protocol import PackageNotFound
from ur.lsp.launch_texts import define_text, is_launch_text, refer_text
from ur.lsp.names import NamedThing, expand_everywhere, find_files, find_name_at, find_thing
from ur.lsp.programs.parameters import KnownParameter, know_parameters
from ur.lsp.programs.places import (
    define_elsewhere,
    find_named,
    list_programs,
    order,
    refer_elsewhere,
    starts_of,
    starts_of_file,
    top_of,
)
from ur.lsp.programs.starts import programs_of_tag
from ur.lsp.workspace import Workspace
from ur.source.file import Span
from ur.tools.find.arguments import find_argument
from ur.tools.find.programs import NodeProgram, program_files
from ur.tools.find.search import Kind, Occurrence, WantedName

LAUNCH_FILES = (".launch", ".xml", ".test")
"""Endings of the names of launch files."""

_SAME_KIND: dict[str, Kind] = {"node": "node", "param": "param", "topic": "topic"}


def find_definitions(workspace: Workspace, path: str, offset: int) -> list[Span]:
    """The definitions of the thing at a place."""
    if is_launch_text(workspace, path):
        return define_text(workspace, path, offset)
    here = find_thing(workspace, path, offset) if path.endswith(LAUNCH_FILES) else None
    if here is None:
        return [] if path.endswith(LAUNCH_FILES) else define_elsewhere(workspace, path, offset)
    view, thing = here
    if thing.kind == "arg":
        return [element.value_span("name") for element in view.declared.get(thing.name, ())]
    if thing.kind == "passed":
        views = (workspace.view(each) for each in included_by(thing, view, workspace))
        return [e.value_span("name") for each in views if each is not None for e in each.declared.get(thing.name, ())]
    if thing.kind == "file":
        return [top_of(each) for each in find_files(thing.name, view, thing.span.start, workspace)]
    if thing.kind == "package":
        return [top_of(f"{folder}/package.xml") for folder in find_packages(thing, view, workspace)]
    if thing.kind == "program":
        return [top_of(each) for each in find_programs(thing, view, workspace)]
    found = order(each for each in _others(thing, view, workspace) if each.defines)
    known = find_parameter(thing, view, workspace) if thing.kind == "param" else None
    return [*found, *known.reads] if known is not None else found


def find_references(workspace: Workspace, path: str, offset: int) -> list[Span]:
    """Every place that speaks of the thing at a place, in the whole workspace, definitions first."""
    if is_launch_text(workspace, path):
        return refer_text(workspace, path, offset)
    here = find_thing(workspace, path, offset) if path.endswith(LAUNCH_FILES) else None
    if here is None:
        return [] if path.endswith(LAUNCH_FILES) else refer_elsewhere(workspace, path, offset)
    view, thing = here
    if thing.kind in ("arg", "passed"):
        files = [path] if thing.kind == "arg" else included_by(thing, view, workspace)
        found = [each for file in files for each in find_argument_in(file, thing.name, workspace)]
    elif thing.kind == "file":
        wanted = set(find_files(thing.name, view, thing.span.start, workspace))
        found = [each for each in _file_uses(workspace) if each.name in wanted]
        found += [Occurrence("file", file, False, span) for file in wanted for span in starts_of_file(file, workspace)]
    elif thing.kind == "package":
        found = list(_package_uses(thing.name, workspace))
    elif thing.kind == "program":
        return [each for program in programs_around(thing, view, workspace) for each in starts_of(program, workspace)]
    else:
        found = list(_others(thing, view, workspace))
    return order(found)


def find_argument_in(path: str, name: str, workspace: Workspace) -> list[Occurrence]:
    """The places of an argument of a file, over the workspace."""
    views = dict(workspace.views)
    if path not in views and (view := workspace.view(path)) is not None:
        views[path] = view
    return list(find_argument(path, name, views, list_programs(workspace))) if path in views else []


def included_by(thing: NamedThing, view: LaunchView, workspace: Workspace) -> list[str]:
    """The files that the `<include>` around a place takes in, in any case."""
    include = thing.cursor.parents[-1]
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
    """The files that the node at a place may run."""
    return [
        each for program in programs_around(thing, view, workspace) for each in program_files(program, workspace.world)
    ]


def programs_around(thing: NamedThing, view: LaunchView, workspace: Workspace) -> list[NodeProgram]:
    """The programs of the `<node>` that holds a place."""
    tags = (thing.cursor.tag, *reversed(thing.cursor.parents))
    node = next((each for each in tags if each is not None and each.name in ("node", "test")), None)
    return programs_of_tag(node, view, workspace) if node is not None else []


def find_parameter(thing: NamedThing, view: LaunchView, workspace: Workspace) -> KnownParameter | None:
    """The parameter at a place, as its program's documents describe it."""
    return know_parameters(programs_around(thing, view, workspace), workspace).get(thing.name.lstrip("~"))


def _others(thing: NamedThing, view: LaunchView, workspace: Workspace) -> Iterator[Occurrence]:
    kind = _SAME_KIND.get(thing.kind)
    if kind is None:
        return
    names = {WantedName(name) for name in _full_names(thing, view, workspace)}
    yield from find_named(kind, names, workspace)


def _full_names(thing: NamedThing, view: LaunchView, workspace: Workspace) -> set[str]:
    # A parameter's, as the tag that sets it is resolved; else what is written.
    tag = thing.cursor.tag
    if thing.kind == "param" and tag is not None:
        params = (param for _, plan, _ in workspace.cases(view) for param in plan.params)
        spans = ((param.name, param.origin) for param in params)
        found = {name for name, at in spans if at.span.file.path == view.path and at.span.start == tag.start}
        if found:
            return found
    return {name.lstrip("~") for name in expand_everywhere(thing.name, view, thing.span.start, workspace)}


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
