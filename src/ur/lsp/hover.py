"""Text about the thing at a place, as Markdown: documentation, values in each case, what a node does."""

from ur.check.rule import LaunchView
from ur.check.worlds import has_marker
from ur.complete.yaml_keys import find_key, plain_parents
from ur.launchfile.plan.specs import NodeSpec
from ur.launchfile.query.topics import find_name_uses
from ur.launchfile.query.vocabulary import DOCUMENTS, find_choices
from ur.lsp.definitions import LAUNCH_FILES, find_packages, find_parameter, find_programs, included_by, programs_around
from ur.lsp.documents import document_of, summary_of
from ur.lsp.launch_texts import describe_text, is_launch_text
from ur.lsp.names import NamedThing, arguments_before, expand_everywhere, find_files, find_thing
from ur.lsp.programs.parameters import describe_parameter, know_parameters
from ur.lsp.programs.starts import programs_of_yaml
from ur.lsp.programs.yaml_keys import is_yaml, know_keys
from ur.lsp.workspace import Workspace
from ur.source.file import Span
from ur.tools.find.programs import read_program

_MOST = 8  # cases, topics


def describe_at(workspace: Workspace, path: str, offset: int) -> tuple[str, Span] | None:
    """Markdown about the thing at a place, and the text that it is about; None where there is nothing to show."""
    if is_launch_text(workspace, path):
        return describe_text(workspace, path, offset)
    if is_yaml(path):
        return _describe_key(workspace, path, offset)
    here = find_thing(workspace, path, offset) if path.endswith(LAUNCH_FILES) else None
    if here is None:
        return None
    view, thing = here
    parts = [each for each in (_describe(thing, view, workspace), _expansion(thing, view, workspace)) if each]
    return ("\n\n".join(parts), thing.span) if parts else None


def _describe(thing: NamedThing, view: LaunchView, workspace: Workspace) -> str:
    if thing.kind in ("tag", "attribute"):
        choices = find_choices(thing.cursor.tag.name if thing.cursor.tag else "", thing.name)
        return " ".join([DOCUMENTS.get(thing.name, ""), f"One of {', '.join(choices)}." if choices else ""]).strip()
    if thing.kind == "arg":
        return _describe_argument(thing.name, view, workspace)
    if thing.kind == "passed":
        views = (workspace.view(each) for each in included_by(thing, view, workspace))
        known = [each for each in views if each is not None and thing.name in each.declared]
        return "\n\n".join(_describe_argument(thing.name, each, workspace) for each in known[:1])
    if thing.kind == "package":
        return "\n".join(f"package `{thing.name}` in `{folder}`" for folder in find_packages(thing, view, workspace))
    if thing.kind == "program":
        return "\n\n".join(f"runs `{each}`" for each in find_programs(thing, view, workspace)[:_MOST])
    if thing.kind == "file":
        files = find_files(thing.name, view, thing.span.start, workspace)
        return "\n\n".join(
            " — ".join(filter(None, (f"`{each}`", summary_of(each, workspace)))) for each in files[:_MOST]
        )
    if thing.kind == "node":
        return _describe_node(thing, view, workspace)
    parameter = find_parameter(thing, view, workspace) if thing.kind == "param" else None
    return describe_parameter(parameter, programs_around(thing, view, workspace)) if parameter is not None else ""


def _describe_key(workspace: Workspace, path: str, offset: int) -> tuple[str, Span] | None:
    source = read_program(path, workspace.world)
    found = find_key(source, offset) if source is not None else None
    if source is None or found is None:
        return None
    parents, span = found
    programs = programs_of_yaml(path, workspace)
    parameter = know_parameters(programs, workspace).get("/".join((*parents, span.text)))
    if parameter is not None:
        return describe_parameter(parameter, programs), span
    known = know_keys(workspace, path, source.text).get(plain_parents(parents), {}).get(span.text)
    document = known.document if known is not None else ""
    return (f"**{span.text}**\n\n{document}", span) if document else None


def _describe_argument(name: str, view: LaunchView, workspace: Workspace) -> str:
    elements = view.declared.get(name, ())
    if not elements:
        return f"argument `{name}` is not declared in this file"
    kind = next(
        (f'{each}="{elements[0].attributes[each]}"' for each in ("default", "value") if each in elements[0].attributes),
        "required",
    )
    values: dict[str, list[str]] = {}
    for case in workspace.cases(view):
        value = arguments_before(case, view, len(view.tree.source.text)).get(name)
        if value is not None and not has_marker(value):
            values.setdefault(value, []).append(case[0])
    lines = [f"**{name}** ({kind})", document_of(name, view)]
    return "\n\n".join(filter(None, (*lines, _list_values(values))))


def _list_values(values: dict[str, list[str]]) -> str:
    if len(values) == 1:
        return f"value: `{next(iter(values))}`"
    rows = [f"- `{value}` with {', '.join(filter(None, cases)) or 'no argument'}" for value, cases in values.items()]
    more = [f"- and {len(rows) - _MOST} other values"] if len(rows) > _MOST else []
    return "\n".join([*rows[:_MOST], *more])


def _expansion(thing: NamedThing, view: LaunchView, workspace: Workspace) -> str:
    place = thing.cursor
    if place.kind != "value" or thing.kind == "file":
        return ""
    value = view.tree.source.text[place.start : place.end]
    if "$(" not in value or value == f"$(arg {thing.name})":
        return ""
    results = expand_everywhere(value, view, place.start, workspace)
    return _list_values({result: [labels] for result, labels in results.items()}) if results else ""


def _describe_node(thing: NamedThing, view: LaunchView, workspace: Workspace) -> str:
    start = thing.cursor.tag.start if thing.cursor.tag is not None else -1
    for _, plan, _ in workspace.cases(view):
        for node in plan.all_nodes():
            if node.origin.span.start == start and node.origin.span.file.path == view.path:
                return describe_node(node)
    return ""


def describe_node(node: NodeSpec) -> str:
    """A node as Markdown: its program and the names that it is known to use."""
    lines = [f"node `{node.full_name}` runs `{node.type}` of package `{node.package}`"]
    uses = find_name_uses(node)
    for use in dict.fromkeys(each.use for each in uses):
        names = [each.name for each in uses if each.use == use]
        shown = ", ".join(f"`{name}`" for name in names[:_MOST]) + (", ..." if len(names) > _MOST else "")
        lines.append(f"- {(use or 'uses').replace('-', ' ')} {shown}")
    return "\n".join(lines)
