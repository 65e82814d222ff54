"""The nodes that run a program, and those that load a YAML file."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from os.path import normpath

from ur.check.collect import collect_targets
from ur.check.rule import LaunchView, survey_launch_file
from ur.check.survey import walk_elements
from ur.launchfile.plan.specs import NodeSpec, ParamSpec, Plan
from ur.launchfile.syntax import Element
from ur.launchfile.world.protocol import PackageNotFound
from ur.lsp.cursor import OpenTag
from ur.lsp.names import expand_everywhere, find_files
from ur.lsp.workspace import Workspace
from ur.source.diagnostic import UserError
from ur.tools.find.programs import NodeProgram, may_name

_MOST_FILES = 60  # launch files of a package outside of the workspace


def programs_of_tag(tag: OpenTag, view: LaunchView, workspace: Workspace) -> list[NodeProgram]:
    """The programs that a `<node>` may run, in any case."""
    text = view.tree.source.text
    written = [text[slice(*tag.values.get(attribute, (0, 0)))] for attribute in ("pkg", "type")]
    return _programs(written, tag.start, view, workspace)


def _programs(written: Sequence[str], start: int, view: LaunchView, workspace: Workspace) -> list[NodeProgram]:
    packages, names = (expand_everywhere(each, view, start, workspace) for each in written)
    return [NodeProgram(package, name) for package in packages for name in names if package and name]


def programs_of_yaml(path: str, workspace: Workspace) -> list[NodeProgram]:
    """The programs of the nodes that load a YAML file, which may be broken, as their private parameters."""
    found: dict[NodeProgram, None] = {}
    for view in workspace.views.values():
        for tag, node in walk_elements(view.tree.launch):
            file = tag.attributes.get("file", "")
            if tag.name != "rosparam" or node is None or node.name not in ("node", "test") or not may_name(file, path):
                continue
            if path in map(normpath, find_files(file, view, tag.start, workspace)):
                written = [node.attributes.get(attribute, "") for attribute in ("pkg", "type")]
                found.update(dict.fromkeys(_programs(written, node.start, view, workspace)))
    return list(found)


def find_starters(program: NodeProgram, workspace: Workspace) -> Iterator[tuple[LaunchView, Plan, NodeSpec]]:
    """The nodes that run a program, in the launch files that hold their tags, in each case."""
    for view in _views_near(program, workspace):
        types = (element.attributes.get("type", "") for element in _elements(view, "node", "test"))
        if any(each == program.name or "$(" in each for each in types):
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
        if any(may_name(element.attributes.get("file", ""), path) for element in _elements(view, "rosparam")):
            for _, plan, _ in workspace.cases(view):
                for param in plan.params:
                    if normpath(param.origin.span.file.path) == path and not param.origin.includes:
                        yield plan, param


def _elements(view: LaunchView, *names: str) -> Iterator[Element]:
    return (element for element, _ in walk_elements(view.tree.launch) if element.name in names)
