"""Programs of nodes: their files, the launch files that start them, and the nodes that read a YAML file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

from ur.check.collect import collect_targets
from ur.check.rule import LaunchView, survey_launch_file
from ur.check.survey import walk_elements
from ur.launchfile.plan.specs import NodeSpec, ParamSpec, Plan
from ur.launchfile.syntax import Element
from ur.launchfile.world.protocol import PackageNotFound
from ur.lsp.names import expand_everywhere
from ur.lsp.place import OpenTag
from ur.lsp.workspace import Workspace
from ur.source.diagnostic import UserError
from ur.source.file import SourceFile, Span

_PIECE = re.compile(r"\$\([^)]*\)")
_MODULE = re.compile(r"^exec .*/lib/node\"? +(ur_nodes(?:\.\w+)+)", re.MULTILINE)
_MOST_FILES = 60  # launch files of a package outside of the workspace
_LARGEST = 1_000_000  # characters of a program


@dataclass(frozen=True, slots=True)
class NodeProgram:
    """A program as nodes name it: `pkg` and `type`."""

    package: str
    name: str


def programs_of_tag(tag: OpenTag, view: LaunchView, workspace: Workspace) -> list[NodeProgram]:
    """The programs that a `<node>` may run, in any case."""
    text = view.tree.source.text
    names = [
        expand_everywhere(text[slice(*tag.values.get(attribute, (0, 0)))], view, tag.start, workspace)
        for attribute in ("pkg", "type")
    ]
    return [NodeProgram(package, name) for package in names[0] for name in names[1] if package and name]


def find_starters(program: NodeProgram, workspace: Workspace) -> Iterator[tuple[LaunchView, Plan, NodeSpec]]:
    """The nodes that run a program, in the launch files that hold their tags, in each case."""
    for view in _views_near(program, workspace):
        if program.name in view.tree.source.text:
            for _, plan, _ in workspace.cases(view):
                for node in plan.all_nodes():
                    if (node.package, node.type) == (program.package, program.name) and not node.origin.includes:
                        yield view, plan, node


def _views_near(program: NodeProgram, workspace: Workspace) -> list[LaunchView]:
    # Those of the workspace, and those of the program's package.
    views = dict(workspace.views)
    with suppress(PackageNotFound, OSError, ValueError, UserError):
        folder = workspace.world.find_package(program.package)
        if not any(path.startswith(f"{folder}/") for path in views):
            targets = collect_targets([folder], workspace.world)
            for path in targets.launch_files[:_MOST_FILES]:
                views[path] = survey_launch_file(path, targets.package_of(path), workspace.world)
    return list(views.values())


def find_loaders(path: str, workspace: Workspace) -> Iterator[tuple[Plan, ParamSpec]]:
    """The parameters that launch files take from a YAML file, in each case."""
    for view in workspace.views.values():
        if any(_may_load(element.attributes.get("file", ""), path) for element in _rosparams(view)):
            for _, plan, _ in workspace.cases(view):
                for param in plan.params:
                    if param.origin.span.file.path == path and not param.origin.includes:
                        yield plan, param


def _rosparams(view: LaunchView) -> Iterator[Element]:
    if "<rosparam" in view.tree.source.text:
        yield from (element for element, _ in walk_elements(view.tree.launch) if element.name == "rosparam")


def _may_load(written: str, path: str) -> bool:
    pieces = _PIECE.split(written)
    return any(pieces) and re.search(".*".join(map(re.escape, pieces)) + r"\Z", path) is not None


def node_of(name: str, plan: Plan) -> NodeSpec | None:
    """The node that a private parameter belongs to."""
    return next((node for node in plan.all_nodes() if name.startswith(f"{node.full_name}/")), None)


def program_files(program: NodeProgram, workspace: Workspace) -> list[str]:
    """The files of a program: what is started, and the module that it runs where it only starts one."""
    with suppress(PackageNotFound, OSError, ValueError):
        found = workspace.world.find_executables(program.package, program.name)
        return list(dict.fromkeys(file for path in found for file in (path, *_module_of(path, workspace))))
    return []


def source_files(program: NodeProgram, workspace: Workspace) -> list[str]:
    """The files in which a program may read its parameters: its own, and the modules beside the one that it runs."""
    files = program_files(program, workspace)
    for path in files[1:]:
        folder = path.rpartition("/")[0]
        beside = (f"{folder}/{name}" for name in workspace.world.list_folder(folder) if name.endswith(".py"))
        files += [each for each in beside if each not in files]
    return files


def _module_of(path: str, workspace: Workspace) -> Iterator[str]:
    source = read_program(path, workspace)
    match = _MODULE.search(source.text) if source is not None else None
    if match is not None:
        from ur.source.project import package_folder

        module = f"{package_folder().parent}/{match[1].replace('.', '/')}.py"
        if workspace.world.is_file(module):
            yield module


def read_program(path: str, workspace: Workspace) -> SourceFile | None:
    """The text of a program; None for what is no text, or a very long one."""
    with suppress(OSError):
        data = workspace.world.read_bytes(path)
        if b"\0" not in data[:1000] and len(data) <= _LARGEST:
            return SourceFile(path, data.decode("utf-8", "replace"))
    return None


def program_of_file(path: str, workspace: Workspace) -> list[NodeProgram]:
    """The programs that a file is, as nodes name it."""
    name = path.rpartition("/")[2]
    session = workspace.session
    package = session.sources.targets.package_of(path) if session is not None else None
    if package is not None:
        with suppress(PackageNotFound, OSError, ValueError):
            if path in workspace.world.find_executables(package.name, name):
                return [NodeProgram(package.name, name)]
    return []


def head_span(source: SourceFile) -> Span:
    """The first line of a program and the headings below it."""
    end = 0
    for line in source.text.splitlines(keepends=True):
        if not line.startswith(("#!", "##")):
            break
        end += len(line)
    return Span(source, 0, end)
