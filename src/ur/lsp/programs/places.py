"""Definitions and uses in files beside launch files: keys of YAML files, and starts of programs."""

import re
from collections.abc import Iterable, Iterator, Set
from os.path import normpath

from ur.check.survey import walk_elements
from ur.complete.yaml_keys import find_key
from ur.lsp.programs.parameters import know_parameters
from ur.lsp.programs.starts import find_loaders, find_starters, programs_of_yaml
from ur.lsp.programs.yaml_keys import is_yaml
from ur.lsp.workspace import Workspace
from ur.source.file import SourceFile, Span
from ur.tools.find.programs import NodeProgram, read_program
from ur.tools.find.search import Kind, Occurrence, WantedName, find_resolved


def define_elsewhere(workspace: Workspace, path: str, offset: int) -> list[Span]:
    """The places that read the key at a place of a YAML file."""
    source = read_program(path, workspace.world) if is_yaml(path) else None
    return [*_read_places(source, offset, workspace)] if source is not None else []


def refer_elsewhere(workspace: Workspace, path: str, offset: int) -> list[Span]:
    """The uses of the key at a place of a YAML file: what it sets, and what reads it."""
    names = {
        WantedName(param.name)
        for _, param in (find_loaders(path, workspace) if is_yaml(path) else ())
        if param.origin.span.start <= offset <= param.origin.span.end
    }
    found = order(find_named("param", names, workspace)) if names else []
    return [*found, *define_elsewhere(workspace, path, offset)]


def _read_places(source: SourceFile, offset: int, workspace: Workspace) -> Iterator[Span]:
    key = find_key(source, offset)
    if key is not None:
        name = "/".join((*key[0], key[1].text))
        known = know_parameters(programs_of_yaml(source.path, workspace), workspace)
        yield from known[name].reads if name in known else ()


def starts_of(program: NodeProgram, workspace: Workspace) -> list[Span]:
    """The `type` of each `<node>` that runs a program."""
    found: dict[tuple[str, int], Span] = {}
    for view, _, node in find_starters(program, workspace):
        elements = (each for each, _ in walk_elements(view.tree.launch))
        element = next((each for each in elements if each.start == node.origin.span.start), None)
        span = element.value_span("type") if element is not None else node.origin.span
        found.setdefault((view.path, span.start), span)
    return list(found.values())


def starts_of_file(path: str, workspace: Workspace) -> list[Span]:
    """The places in programs of the workspace that name a launch file, outside of comments."""
    name = re.compile(rf"(?<![\w.-]){re.escape(path.rpartition('/')[2])}(?![\w.-])")
    found = (Span(source, *match.span()) for source in list_programs(workspace) for match in name.finditer(source.text))
    return [span for span in found if not span.file.line(span.position.line).lstrip().startswith("#")]


def list_programs(workspace: Workspace) -> list[SourceFile]:
    """The programs of the workspace's packages, which may start launch files with arguments."""
    session = workspace.session
    if session is None:
        return []
    paths = session.sources.targets.programs
    return [text for path in paths if (text := session.sources.read_text(path)) is not None]


def find_named(kind: Kind, names: Set[WantedName], workspace: Workspace) -> Iterator[Occurrence]:
    """The nodes, parameters or topics with these full names in the launch files of the workspace, and in their YAML."""
    for view in workspace.views.values():
        text = view.tree.source.text
        if not any(name.name.rpartition("/")[2] in text for name in names) and (
            kind != "param" or "<rosparam" not in text
        ):
            continue  # which may be included by what resolves it
        for each in find_resolved(view, workspace.world, frozenset({kind}), follow=False):
            if any(name.matches(each.name) for name in names):
                yield each


def order(found: Iterable[Occurrence]) -> list[Span]:
    """The places of occurrences, definitions first, each once."""
    ordered = sorted(found, key=lambda each: (not each.defines, each.span.file.path, each.span.start))
    return list({(normpath(each.span.file.path), each.span.start): each.span for each in ordered}.values())


def top_of(path: str) -> Span:
    """The start of a file."""
    return Span(SourceFile(path, ""), 0, 0)
