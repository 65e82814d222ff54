"""The language server: requests of an editor to functions of the workspace, and findings back to the editor."""

import asyncio
import gc
import time

from lsprotocol import types
from pygls.lsp.server import LanguageServer
from pygls.workspace import TextDocument

from ur.lsp.convert import Units, move_span, path_of, uri_of
from ur.lsp.workspace import MakeWorld, Workspace
from ur.source.file import SourceFile

_TURN = 0.005  # seconds of work before the next message is looked at
_QUIET = 0.03  # seconds without a message after which other files are looked at
_IDLE = 2.0  # seconds without work after which memory is collected, which would keep a key waiting


class LaunchServer(LanguageServer):
    """A server for the launch files of an editor's folders."""

    def __init__(self, version: str, make_world: MakeWorld) -> None:
        super().__init__("ur", version, text_document_sync_kind=types.TextDocumentSyncKind.Incremental)
        self.make_world = make_world
        self.files = Workspace([], make_world)
        self.units = Units(types.PositionEncodingKind.Utf16)
        self._published: dict[str, object] = {}
        self._first: list[str] = []
        self._working: asyncio.Task[None] | None = None
        self._collecting: asyncio.TimerHandle | None = None

    def begin(self, folders: list[str]) -> None:
        """Open folders, in place of those that were open."""
        gc.disable()
        self.files = Workspace(folders, self.make_world)
        self.units = Units(self.workspace.position_encoding or types.PositionEncodingKind.Utf16)

    def update(self, uri: str, document: TextDocument | None) -> None:
        """Take the text of a document, or with None that of the file, and find what is wrong in it."""
        path = path_of(uri)
        if path is None:
            return
        if document is None:
            self.files.drop_text(path)
        else:
            self.files.set_text(path, document.source)
        self.find(path)

    def find(self, path: str) -> None:
        """Find what is wrong, in `path` first."""
        self._first = [path, *(each for each in self._first if each != path)][:8]
        if self._collecting is not None:
            self._collecting.cancel()
        if self._working is None or self._working.done():
            self._working = asyncio.get_running_loop().create_task(self._work())

    async def _work(self) -> None:
        while True:
            version = self.files.version
            began = time.monotonic()
            waited = False
            for touched in self.files.steps(self._first):
                self._publish(touched)
                if not waited and touched and self._first[0] in touched:
                    # What depends on the file takes longer, and is in vain where the next letter comes.
                    waited = True
                    await asyncio.sleep(_QUIET)
                elif time.monotonic() - began > _TURN:
                    await asyncio.sleep(0)
                    began = time.monotonic()
                if self.files.version != version:
                    break
            else:
                self._collecting = asyncio.get_running_loop().call_later(_IDLE, gc.collect)
                return

    def _publish(self, paths: frozenset[str]) -> None:
        for path in paths:
            if not path.startswith("/"):
                continue
            found = self._diagnostics(path)
            if found != self._published.get(path, []):
                self._published[path] = found
                self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri_of(path), found))

    def _diagnostics(self, path: str) -> list[types.Diagnostic]:
        now: SourceFile | None = None
        diagnostics = []
        for found in self.files.findings_of(path):
            assert found.span is not None
            if now is None:
                try:
                    now = self.files.source(path)
                except OSError:
                    now = found.span.file
            span = move_span(found.span, now)
            if span is not None:
                diagnostics.append(self.units.diagnostic(found, span))
        return diagnostics

    def read(self, path: str) -> SourceFile:
        """The text of a file, empty where it cannot be read."""
        try:
            return self.files.source(path)
        except OSError:
            return SourceFile(path, "")
