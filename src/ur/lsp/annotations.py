"""Semantic tokens, inlay hints and code lenses of a launch file."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from ur.check.rule import LaunchView
from ur.check.survey import walk_elements
from ur.launchfile.syntax import Element
from ur.lsp.names import arguments_before, expand
from ur.lsp.workspace import ResolvedCase, Workspace
from ur.source.file import Span

TokenKind = Literal["macro", "parameter", "namespace", "function", "string", "keyword"]
TOKEN_KINDS: tuple[TokenKind, ...] = ("macro", "parameter", "namespace", "function", "string", "keyword")
_PIECE = re.compile(r"\$\((\w+)\s*([^)]*)\)")
_PLAIN_PATH = re.compile(r"\$\((?:find [\w.-]+|dirname)\)/[^$]*")  # its result would only repeat it
_LONG = 40
_EMPTY = "''"
_NAMES: dict[tuple[str, str], TokenKind] = {
    ("arg", "name"): "parameter",
    ("node", "name"): "function",
    ("node", "pkg"): "namespace",
    ("node", "type"): "function",
}


@dataclass(frozen=True, slots=True)
class SemanticToken:
    """A word with its kind."""

    span: Span
    kind: TokenKind


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


def list_semantic_tokens(view: LaunchView) -> list[SemanticToken]:
    """The words of a file that have a meaning beyond XML, in order, without overlaps."""
    found = [word for element, _ in walk_elements(view.tree.launch) for word in _words_of(element)]
    return sorted(found, key=lambda each: each.span.start)


def _words_of(element: Element) -> Iterator[SemanticToken]:
    for attribute in element.attributes:
        span = element.value_span(attribute)
        if span.start == element.start:
            continue
        kind = _NAMES.get((element.name, attribute))
        if "$(" not in span.text:
            if kind is not None and span.text and "\n" not in span.text:
                yield SemanticToken(span, kind)
            continue
        for piece in _PIECE.finditer(span.text):
            start = span.start + piece.start(1)
            yield SemanticToken(Span(span.file, start, start + len(piece.group(1))), "macro")
            if piece.group(1) in ("arg", "find") and piece.group(2).strip() and "\n" not in piece.group(2):
                start = span.start + piece.start(2)
                word = Span(span.file, start, start + len(piece.group(2).rstrip()))
                yield SemanticToken(word, "parameter" if piece.group(1) == "arg" else "namespace")


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
