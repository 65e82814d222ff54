"""A client of `ur lsp` over standard input and output, as an editor is one."""

import asyncio
import gc
import os
import socket
import sys
import threading
from collections.abc import AsyncIterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path

from lsprotocol import types
from pygls.io_ import run_async
from pygls.lsp.client import LanguageClient

from ur.check.worlds import make_world
from ur.lsp.serve import make_server

PATIENCE = 60  # seconds


class Editor:
    """Documents that are open, and what the server has published about them."""

    def __init__(self, client: LanguageClient, folder: Path) -> None:
        self.client = client
        self.folder = folder
        self.published: dict[str, list[types.Diagnostic]] = {}
        self.texts: dict[str, str] = {}
        self._news = asyncio.Event()
        self._version = 0

    def take(self, params: types.PublishDiagnosticsParams) -> None:
        self.published[params.uri] = list(params.diagnostics)
        self._news.set()

    def uri(self, name: str) -> str:
        return (self.folder / name).as_uri()

    def document(self, name: str) -> types.TextDocumentIdentifier:
        return types.TextDocumentIdentifier(self.uri(name))

    def open(self, name: str, text: str | None = None) -> None:
        text = (self.folder / name).read_text() if text is None else text
        self.texts[name] = text
        item = types.TextDocumentItem(self.uri(name), "xml", 1, text)
        self.client.text_document_did_open(types.DidOpenTextDocumentParams(item))

    def replace(self, name: str, old: str, new: str) -> None:
        """Replace a text that occurs once, as typing does."""
        text = self.texts[name]
        assert text.count(old) == 1, old
        start = text.index(old)
        self._version += 1
        change = types.TextDocumentContentChangePartial(
            types.Range(position_of(text, start), position_of(text, start + len(old))), new
        )
        document = types.VersionedTextDocumentIdentifier(self._version, self.uri(name))
        self.client.text_document_did_change(types.DidChangeTextDocumentParams(document, [change]))
        self.texts[name] = text.replace(old, new)

    async def wait_for(self, name: str, codes: Sequence[str]) -> list[types.Diagnostic]:
        """Wait until exactly these rules are published for a file."""
        while sorted(str(each.code) for each in self.published.get(self.uri(name), [])) != sorted(codes):
            self._news.clear()
            try:
                await asyncio.wait_for(self._news.wait(), PATIENCE)
            except asyncio.TimeoutError:
                raise AssertionError(f"{self.published.get(self.uri(name))}, expected {codes}") from None
        return self.published.get(self.uri(name), [])

    def at(self, name: str, text: str, shift: int = 0) -> types.Position:
        """The position of the first letter of a text that occurs once."""
        assert self.texts[name].count(text) == 1, text
        return position_of(self.texts[name], self.texts[name].index(text) + shift)


def position_of(text: str, offset: int) -> types.Position:
    before = text[:offset]
    column = len(before.rpartition("\n")[2].encode("utf-16-le")) // 2
    return types.Position(before.count("\n"), column)


@asynccontextmanager
async def open_editor(
    folder: Path, environment: dict[str, str] | None = None, *, inside: bool = False
) -> AsyncIterator[Editor]:
    """A server on a folder, initialised, as a process or `inside` this one; it ends with the context."""
    client = LanguageClient("tests", "1")
    editor = Editor(client, folder)

    @client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)  # type: ignore[untyped-decorator]
    def _take(params: types.PublishDiagnosticsParams) -> None:
        editor.take(params)

    variables = {**os.environ, "ROS_PACKAGE_PATH": "", **(environment or {})}
    async with AsyncExitStack() as stack:
        if inside:
            await stack.enter_async_context(_serve_inside(client, variables))
        else:
            await client.start_io(sys.executable, "-I", "-m", "ur", "lsp", env=variables)
        await client.initialize_async(
            types.InitializeParams(
                capabilities=types.ClientCapabilities(),
                workspace_folders=[types.WorkspaceFolder(folder.as_uri(), folder.name)],
            )
        )
        client.initialized(types.InitializedParams())
        try:
            yield editor
        finally:
            await client.shutdown_async(None)
            if not inside:
                client.exit(None)
                await client.stop()  # type: ignore[no-untyped-call]


@asynccontextmanager
async def _serve_inside(client: LanguageClient, environment: dict[str, str]) -> AsyncIterator[None]:
    """A server in this process, which the client reaches through a socket."""
    server = make_server("1", lambda paths: make_world(paths, environment))
    stop = threading.Event()

    tasks, writers = [], []
    for protocol, end in zip((server.protocol, client.protocol), socket.socketpair(), strict=True):
        reader, writer = await asyncio.open_connection(sock=end)
        protocol.set_writer(writer)
        writers.append(writer)
        tasks.append(asyncio.create_task(run_async(stop, reader, protocol)))
    try:
        yield
    finally:
        stop.set()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        for writer in writers:
            writer.close()
        gc.enable()  # the server collects memory itself
