"""The requests of the protocol, each a function of the workspace and a place, in the protocol's types."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from ur.check.rule import TextEdit
from ur.lsp.actions import format_text, list_actions
from ur.lsp.completion import complete
from ur.lsp.convert import path_of
from ur.lsp.cursor import Candidate, CandidateKind
from ur.lsp.definitions import find_definitions, find_references
from ur.lsp.hover import describe_at
from ur.lsp.symbols import Symbol, SymbolKind, list_folds, list_symbols, outline
from ur.source.file import Span

if TYPE_CHECKING:
    from ur.lsp.server import LaunchServer

_CANDIDATES: dict[CandidateKind, types.CompletionItemKind] = {
    "tag": types.CompletionItemKind.Class,
    "attribute": types.CompletionItemKind.Property,
    "package": types.CompletionItemKind.Module,
    "program": types.CompletionItemKind.Function,
    "file": types.CompletionItemKind.File,
    "folder": types.CompletionItemKind.Folder,
    "argument": types.CompletionItemKind.Variable,
    "value": types.CompletionItemKind.Value,
    "rule": types.CompletionItemKind.Constant,
}
_SYMBOLS: dict[SymbolKind, types.SymbolKind] = {
    "argument": types.SymbolKind.Variable,
    "node": types.SymbolKind.Function,
    "include": types.SymbolKind.Module,
    "group": types.SymbolKind.Namespace,
    "param": types.SymbolKind.Property,
    "remap": types.SymbolKind.Event,
    "machine": types.SymbolKind.Object,
    "file": types.SymbolKind.File,
    "env": types.SymbolKind.Constant,
}


def add_answers(server: LaunchServer) -> None:
    """Register everything that a client may ask."""
    _add_places(server)
    _add_files(server)
    _add_actions(server)


def _place(server: LaunchServer, uri: str, position: types.Position) -> tuple[str, int] | None:
    path = path_of(uri)
    return (path, server.units.offset(server.read(path), position)) if path is not None else None


def _locations(server: LaunchServer, spans: list[Span]) -> list[types.Location]:
    return [server.units.location(span, server.read) for span in spans]


def _add_places(server: LaunchServer) -> None:
    @server.feature(types.TEXT_DOCUMENT_HOVER)
    def _hover(params: types.HoverParams) -> types.Hover | None:
        place = _place(server, params.text_document.uri, params.position)
        found = describe_at(server.files, *place) if place is not None else None
        if found is None:
            return None
        text = types.MarkupContent(types.MarkupKind.Markdown, found[0])
        return types.Hover(text, server.units.range(found[1]))

    options = types.CompletionOptions(trigger_characters=["<", " ", '"', "'", "/", "(", "=", "#"])

    @server.feature(types.TEXT_DOCUMENT_COMPLETION, options)
    def _complete(params: types.CompletionParams) -> list[types.CompletionItem]:
        place = _place(server, params.text_document.uri, params.position)
        if place is None:
            return []
        source = server.read(place[0])
        found = complete(server.files, *place)
        return [_item(server, each, Span(source, each.start, each.end), number) for number, each in enumerate(found)]

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    def _define(params: types.DefinitionParams) -> list[types.Location]:
        place = _place(server, params.text_document.uri, params.position)
        return _locations(server, find_definitions(server.files, *place)) if place is not None else []

    @server.feature(types.TEXT_DOCUMENT_REFERENCES)
    def _refer(params: types.ReferenceParams) -> list[types.Location]:
        place = _place(server, params.text_document.uri, params.position)
        return _locations(server, find_references(server.files, *place)) if place is not None else []


def _item(server: LaunchServer, found: Candidate, span: Span, number: int) -> types.CompletionItem:
    return types.CompletionItem(
        found.label,
        kind=_CANDIDATES[found.kind],
        detail=found.help or None,
        documentation=types.MarkupContent(types.MarkupKind.Markdown, found.document) if found.document else None,
        sort_text=f"{number:05}",
        filter_text=span.file.text[span.start : span.end] and found.insert,
        text_edit=types.TextEdit(server.units.range(span), found.insert),
        command=types.Command("", "editor.action.triggerSuggest") if found.more else None,
    )


def _add_files(server: LaunchServer) -> None:
    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def _outline(params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
        view = server.files.view(path_of(params.text_document.uri) or "")
        return [_symbol(server, each) for each in outline(view)] if view is not None else []

    @server.feature(types.WORKSPACE_SYMBOL)
    def _symbols(params: types.WorkspaceSymbolParams) -> list[types.SymbolInformation]:
        return [
            types.SymbolInformation(server.units.location(each.named, server.read), each.name, _SYMBOLS[each.kind])
            for each in list_symbols(server.files, params.query)
        ]

    @server.feature(types.TEXT_DOCUMENT_FOLDING_RANGE)
    def _fold(params: types.FoldingRangeParams) -> list[types.FoldingRange]:
        view = server.files.view(path_of(params.text_document.uri) or "")
        return [
            types.FoldingRange(
                fold.first - 1, fold.last - 1, kind=types.FoldingRangeKind.Comment if fold.comment else None
            )
            for fold in (list_folds(view) if view is not None else [])
        ]

    @server.feature(types.TEXT_DOCUMENT_FORMATTING)
    def _format(params: types.DocumentFormattingParams) -> list[types.TextEdit] | None:
        path = path_of(params.text_document.uri)
        text = format_text(server.files, path) if path is not None else None
        if path is None or text is None:
            return None
        source = server.read(path)
        return [server.units.edit(TextEdit(Span(source, 0, len(source.text)), text))]


def _symbol(server: LaunchServer, found: Symbol) -> types.DocumentSymbol:
    return types.DocumentSymbol(
        found.name,
        _SYMBOLS[found.kind],
        server.units.range(found.whole),
        server.units.range(found.named),
        detail=found.detail or None,
        children=[_symbol(server, each) for each in found.inside],
    )


def _add_actions(server: LaunchServer) -> None:
    kinds = types.CodeActionOptions([types.CodeActionKind.QuickFix])

    @server.feature(types.TEXT_DOCUMENT_CODE_ACTION, kinds)
    def _act(params: types.CodeActionParams) -> list[types.CodeAction]:
        start = _place(server, params.text_document.uri, params.range.start)
        end = _place(server, params.text_document.uri, params.range.end)
        if start is None or end is None:
            return []
        actions = []
        for each in list_actions(server.files, start[0], start[1], end[1]):
            edit = types.WorkspaceEdit(server.units.edits(each.edits))
            found = each.fixes
            fixed = (
                [server.units.diagnostic(found, found.span)] if found is not None and found.span is not None else None
            )
            actions.append(types.CodeAction(each.title, types.CodeActionKind.QuickFix, fixed, edit=edit))
        return actions
