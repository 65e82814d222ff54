"""The script of three.js from a Python package, which is installed when a page first opens its 3D view."""

import asyncio
import gzip
import importlib
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path

from aiohttp import web

from ur.web.runs.commands import CommandQueue

_PACKAGE, _SCRIPT = "jupyter_threejs_sage", "static/r130/three.min.js"
_INSTALL_LIMIT = 300.0  # s
_HEADERS = {"Content-Type": "text/javascript; charset=utf-8", "Cache-Control": "no-cache"}


def find_script() -> Path | None:
    """Find the file of three.js; None if its package is not installed."""
    importlib.invalidate_caches()  # it may have been installed since
    found = find_spec(_PACKAGE)
    folders = found.submodule_search_locations if found is not None else None
    path = Path(folders[0], _SCRIPT) if folders else None
    return path if path is not None and path.is_file() else None


class ThreeScript:
    """Serves the script; `commands` runs the command that installs it."""

    def __init__(self, commands: CommandQueue, find: Callable[[], Path | None] = find_script) -> None:
        self._commands, self._find = commands, find
        self._lock = asyncio.Lock()
        self._packed: bytes | None = None

    async def serve(self, request: web.Request) -> web.Response:
        """Respond with the script. Raises HTTPServiceUnavailable if it cannot be installed."""
        async with self._lock:
            if self._packed is None:
                path = self._find() or await self._install()
                compress = partial(gzip.compress, path.read_bytes(), 9, mtime=0)
                self._packed = await asyncio.get_running_loop().run_in_executor(None, compress)
        headers = {**_HEADERS, "ETag": f'"{_PACKAGE}-{_SCRIPT}"'}
        if request.headers.get("If-None-Match") == headers["ETag"]:
            return web.Response(status=304, headers=headers)
        if "gzip" in request.headers.get("Accept-Encoding", ""):
            return web.Response(body=self._packed, headers={**headers, "Content-Encoding": "gzip"})
        return web.Response(body=gzip.decompress(self._packed), headers=headers)

    async def _install(self) -> Path:
        done = await self._commands.run("web", "--prepare-3d", limit=_INSTALL_LIMIT)
        path = self._find()
        if path is None:
            lines = [line for line in done.err.splitlines() if line.startswith("error: ")] or ["error: no answer"]
            text = f"the 3D view cannot be installed: {lines[-1].removeprefix('error: ')[:300]}\n"
            raise web.HTTPServiceUnavailable(text=text)
        return path
