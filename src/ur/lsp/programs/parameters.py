"""Documentation, values and places of a program's parameters."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache

from ur.check.rule import LaunchView
from ur.check.survey import walk_elements
from ur.complete.yaml_keys import comment_on_line
from ur.launchfile.plan.specs import ParamSpec, ParamValue
from ur.lsp.documents import document_of
from ur.lsp.programs.starts import find_starters
from ur.lsp.workspace import Workspace
from ur.source.file import Span
from ur.tools.find.programs import NodeProgram, read_program, source_files
from ur.tools.new.node_defaults import read_defaults

_LONGEST_VALUE = 60
_MOST_VALUES = 8
_ARGUMENT = re.compile(r"\$\(arg (\w+)\)")
_READ = re.compile(r"""\(\s*f?["']~?([\w/]+)["']""")
_AFTER_TAG = re.compile(r"[^\n]*?>[ \t]*<!--(?!ur:)\s*(.*?)\s*-->")
_read_defaults = lru_cache(maxsize=128)(read_defaults)


@dataclass(slots=True)
class KnownParameter:
    """A parameter below a node's name. `values` maps each to the files that give it; `reads` are places in sources."""

    name: str
    document: str = ""
    values: dict[str, dict[str, None]] = field(default_factory=dict)
    spans: dict[tuple[str, int], Span] = field(default_factory=dict)
    reads: list[Span] = field(default_factory=list)

    def note_value(self, value: str, file: str) -> None:
        """Add a value with the file that gives it."""
        if value and len(value) <= _LONGEST_VALUE and "\n" not in value:
            self.values.setdefault(value, {})[file] = None


def know_parameters(programs: Iterable[NodeProgram], workspace: Workspace) -> dict[str, KnownParameter]:
    """The parameters of programs, by name: those that launch files give them, and those that their sources read."""
    known: dict[str, KnownParameter] = {}
    for program in dict.fromkeys(programs):
        for view, plan, node in find_starters(program, workspace):
            prefix = f"{node.full_name}/"
            for param in plan.params:
                if param.name.startswith(prefix) and not param.origin.includes:
                    _note_given(param, param.name[len(prefix) :], view, known)
        for path in source_files(program, workspace.world):
            source = read_program(path, workspace.world)
            if source is not None:
                for name, value in _read_defaults(source.text).items():
                    known.setdefault(name, KnownParameter(name)).note_value(write_value(value), "its source")
                for match in _READ.finditer(source.text):
                    if match[1] in known:
                        known[match[1]].reads.append(Span(source, *match.span(1)))
    return known


def _note_given(param: ParamSpec, name: str, view: LaunchView, known: dict[str, KnownParameter]) -> None:
    found = known.setdefault(name, KnownParameter(name))
    span = param.origin.span
    found.note_value(write_value(param.value), span.file.path.rpartition("/")[2])
    if found.spans.setdefault((span.file.path, span.start), span) is span:
        found.document = found.document or _document(span, view)


def _document(span: Span, view: LaunchView) -> str:
    if span.file.path != view.path:
        return comment_on_line(span.file.text.split("\n"), span.position.line - 1)
    for element, _ in walk_elements(view.tree.launch):
        if element.start == span.start and element.name == "param":
            argument = _ARGUMENT.fullmatch(element.attributes.get("value", ""))
            after = _AFTER_TAG.match(span.file.text, element.tag_span.end - 1)
            return (document_of(argument[1], view) if argument else "") or (after[1] if after else "")
    return ""


def write_value(value: ParamValue | object) -> str:
    """A value as YAML has it, in one line; empty for what is large."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float | str):
        return str(value)
    if isinstance(value, list) and all(isinstance(each, int | float | str) for each in value):
        return f"[{', '.join(map(write_value, value))}]"
    return ""


def describe_parameter(found: KnownParameter, programs: Iterable[NodeProgram]) -> str:
    """A parameter as Markdown: its program, documentation, and values with the files that give them."""
    names = ", ".join(f"`{each.name}`" for each in dict.fromkeys(programs))
    return "\n\n".join(filter(None, (f"**{found.name}** of {names}", found.document, "\n".join(_values(found)))))


def _values(found: KnownParameter) -> Iterator[str]:
    for value, files in list(found.values.items())[:_MOST_VALUES]:
        shown = ", ".join(list(files)[:4]) + (", ..." if len(files) > 4 else "")
        yield f"- `{value}` in {shown}"
    if len(found.values) > _MOST_VALUES:
        yield f"- and {len(found.values) - _MOST_VALUES} other values"
