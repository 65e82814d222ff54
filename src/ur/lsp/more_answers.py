"""Requests of the protocol about names and annotations: rename, values, commands."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from ur.check.rule import LaunchView, TextEdit
from ur.check.survey import walk_elements
from ur.launchfile.query.written import find_written
from ur.launchfile.syntax import Element
from ur.lsp.convert import path_of
from ur.lsp.definitions import included_by
from ur.lsp.launch_texts import declaring_file, is_launch_text
from ur.lsp.names import arguments_before, expand, find_name_at
from ur.lsp.programs.places import list_programs
from ur.lsp.workspace import ResolvedCase, Workspace
from ur.source.diagnostic import UserError
from ur.source.file import Span
from ur.tools.find.arguments import rename_argument

if TYPE_CHECKING:
    from ur.lsp.server import LaunchServer


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


def add_more_answers(server: LaunchServer) -> None:
    """Register what a client may ask about names and annotations."""
    _add_rename(server)
    _add_annotations(server)
    _add_commands(server)


def _argument_at(server: LaunchServer, uri: str, position: types.Position) -> tuple[str, Span] | None:
    # The file that declares the argument at a position, and the argument.
    path = path_of(uri) or ""
    view = server.files.view(path)
    if view is None:
        return None
    source = view.tree.source
    offset = server.units.offset(source, position)
    if is_launch_text(server.files, path):
        written = find_written(source, offset)
        known = written is not None and written.kind in ("arg", "passed")
        file = declaring_file(server.files, source, written) if written is not None and known else None
        return (file, written.span) if written is not None and file in server.files.views else None
    thing = find_name_at(source, offset)
    if thing is None or thing.kind not in ("arg", "passed"):
        return None
    files = [path] if thing.kind == "arg" else included_by(thing, view, server.files)
    return (files[0], thing.span) if files and files[0] in server.files.views else None


def _add_rename(server: LaunchServer) -> None:
    @server.feature(types.TEXT_DOCUMENT_PREPARE_RENAME)
    def _prepare(params: types.PrepareRenameParams) -> types.Range | None:
        found = _argument_at(server, params.text_document.uri, params.position)
        return server.units.range(found[1]) if found is not None else None

    @server.feature(types.TEXT_DOCUMENT_RENAME, types.RenameOptions(prepare_provider=True))
    def _rename(params: types.RenameParams) -> types.WorkspaceEdit | None:
        found = _argument_at(server, params.text_document.uri, params.position)
        if found is None:
            return None
        files = server.files
        try:
            spans = rename_argument(
                found[0], found[1].text, params.new_name, files.views, files.world, list_programs(files)
            )
        except UserError as problem:
            raise JsonRpcInvalidParams(problem.diagnostics[0].message) from None
        return types.WorkspaceEdit(server.units.edits(TextEdit(span, params.new_name) for span in spans))


def _add_annotations(server: LaunchServer) -> None:
    @server.feature(types.TEXT_DOCUMENT_INLAY_HINT)
    def _hints(params: types.InlayHintParams) -> list[types.InlayHint]:
        view = server.files.view(path_of(params.text_document.uri) or "")
        if view is None:
            return []
        source = view.tree.source
        start, end = (server.units.offset(source, each) for each in (params.range.start, params.range.end))
        return [
            types.InlayHint(server.units.position(source, hint.span.start), hint.text)
            for hint in list_inlay_hints(server.files, view, start, end)
        ]

    @server.feature(types.TEXT_DOCUMENT_CODE_LENS)
    def _lenses(params: types.CodeLensParams) -> list[types.CodeLens]:
        view = server.files.view(path_of(params.text_document.uri) or "")
        lenses = list_code_lenses(server.files, view) if view is not None else []
        arguments = [params.text_document.uri]
        return [
            types.CodeLens(server.units.range(each.span), types.Command(each.title, each.command, arguments=arguments))
            for each in lenses
        ]


def _add_commands(server: LaunchServer) -> None:
    @server.command("ur.check")
    def _check(uri: str) -> str:
        """Find all findings, with their number in one file."""
        path = path_of(uri) or ""
        for _ in server.files.steps([path]):
            pass
        count = len(server.files.findings_of(path))
        text = f"{path.rpartition('/')[2]}: {count or 'no'} finding{'' if count == 1 else 's'}"
        server.window_show_message(types.ShowMessageParams(types.MessageType.Info, text))
        return text
