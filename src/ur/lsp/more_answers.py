"""Requests of the protocol about names and annotations: rename, values, commands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from ur.check.rule import TextEdit
from ur.launchfile.query.written import find_written
from ur.lsp.annotations import list_code_lenses, list_inlay_hints
from ur.lsp.convert import path_of
from ur.lsp.definitions import included_by
from ur.lsp.launch_texts import declaring_file, is_launch_text
from ur.lsp.names import find_name_at
from ur.lsp.programs.places import list_programs
from ur.source.diagnostic import UserError
from ur.source.file import Span
from ur.tools.find.arguments import rename_argument

if TYPE_CHECKING:
    from ur.lsp.server import LaunchServer


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
