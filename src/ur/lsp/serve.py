"""The server with everything that it answers."""

from lsprotocol import types

from ur.lsp.answers import add_answers
from ur.lsp.convert import path_of
from ur.lsp.more_answers import add_more_answers
from ur.lsp.server import LaunchServer
from ur.lsp.workspace import MakeWorld


def make_server(version: str, make_world: MakeWorld) -> LaunchServer:
    """A server that is not started yet; `make_world` gives the packages and files for the paths that are opened."""
    server = LaunchServer(version, make_world)
    _add_documents(server)
    add_answers(server)
    add_more_answers(server)
    return server


def _add_documents(server: LaunchServer) -> None:
    @server.feature(types.INITIALIZED)
    def _initialized(_: types.InitializedParams) -> None:
        uris = list(server.workspace.folders) or ([server.workspace.root_uri] if server.workspace.root_uri else [])
        server.begin([path for path in map(path_of, uris) if path is not None])

    @server.feature(types.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS)
    def _folders(_: types.DidChangeWorkspaceFoldersParams) -> None:
        server.begin([path for path in map(path_of, server.workspace.folders) if path is not None])
        for uri, document in server.workspace.text_documents.items():
            server.update(uri, document)

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def _open(params: types.DidOpenTextDocumentParams) -> None:
        uri = params.text_document.uri
        server.update(uri, server.workspace.get_text_document(uri))

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def _change(params: types.DidChangeTextDocumentParams) -> None:
        uri = params.text_document.uri
        server.update(uri, server.workspace.get_text_document(uri))

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def _close(params: types.DidCloseTextDocumentParams) -> None:
        server.update(params.text_document.uri, None)

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    def _save(params: types.DidSaveTextDocumentParams) -> None:
        path = path_of(params.text_document.uri)
        if path is not None:
            server.files.note_change(path)
            server.find(path)

    @server.feature(types.WORKSPACE_DID_CHANGE_WATCHED_FILES)
    def _watched(params: types.DidChangeWatchedFilesParams) -> None:
        for change in params.changes:
            path = path_of(change.uri)
            if path is not None:
                server.files.note_change(path)
                server.find(path)
