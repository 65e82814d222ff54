"""Inlay hints and code lenses of a launch file."""

import re
from dataclasses import dataclass
from typing import Literal

from ur.check.rule import LaunchView
from ur.check.survey import walk_elements
from ur.launchfile.syntax import Element
from ur.lsp.names import arguments_before, expand
from ur.lsp.workspace import ResolvedCase, Workspace
from ur.source.file import Span

_PLAIN_PATH = re.compile(r"\$\((?:find [\w.-]+|dirname)\)/[^$]*")  # its result would only repeat it
_LONG = 40
_EMPTY = "''"


@dataclass(frozen=True, slots=True)
class InlayHint:
    """A text to show after an offset, which is not part of the file."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class CodeLens:
    """A command above a tag."""

    span: Span
    title: str
    command: Literal["ur.check", "ur.graph", "ur.launch"]


def list_inlay_hints(workspace: Workspace, view: LaunchView, start: int, end: int) -> list[InlayHint]:
    """The results of values with `$(...)` between two offsets, where they are the same in every case."""
    cases = workspace.cases(view)
    found = []
    for element, _ in walk_elements(view.tree.launch):
        for attribute, value in element.attributes.items():
            if "$(" not in value or _PLAIN_PATH.fullmatch(value) or not start <= element.start < end:
                continue
            span = element.value_span(attribute)
            results = {_result(value, case, view, element, workspace) for case in cases}
            if len(results) == 1 and (result := results.pop()) is not None and result != value:
                shown = result if len(result) <= _LONG else f"...{result[3 - _LONG :]}"
                found.append(InlayHint(Span(span.file, span.end + 1, span.end + 1), f" = {shown or _EMPTY}"))
    return found


def _result(value: str, case: ResolvedCase, view: LaunchView, element: Element, workspace: Workspace) -> str | None:
    return expand(value, arguments_before(case, view, element.start - 1), view.path, workspace)


def list_code_lenses(workspace: Workspace, view: LaunchView) -> list[CodeLens]:
    """Commands for a whole file, above its `<launch>`."""
    launch = view.tree.launch
    if launch is None:
        return []
    bases = len(view.package.bases) if view.package is not None and "robot_base" in view.declared else 0
    found = len(workspace.findings_of(view.path))
    state = "no findings" if not found else "1 finding" if found == 1 else f"{found} findings"
    title = f"Check for all {bases} bases: {state}" if bases else f"Check: {state}"
    lenses = [CodeLens(launch.span, title, "ur.check"), CodeLens(launch.span, "Show graph", "ur.graph")]
    session = workspace.session
    if view.path.endswith(".launch") or (session is not None and not session.sources.inclusions.tags.get(view.path)):
        lenses.append(CodeLens(launch.span, "Launch", "ur.launch"))
    return lenses
