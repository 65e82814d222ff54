"""The process that offers topics to Foxglove: started for the first viewer, ended after the last one."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

from ur.source.foreign.json_values import read_json
from ur.system.child_processes import read_errors, start_child, wait_or_kill
from ur.system.ros import node_command

_MODULE = "ur_nodes.web.viewers.viewer_end_node"
_START_LIMIT = 20.0  # s


@dataclass(frozen=True, slots=True)
class _Address:
    host: Annotated[str, Meta(pattern=r"^127\.[0-9.]{1,12}\Z")]
    port: Annotated[int, Meta(gt=0, lt=1 << 16)]


class ViewerProcessError(Exception):
    """The process does not start; the text is the reason, in one line."""


class ViewerProcess:
    """Keeps the process running while a client holds it. `log` is called with its output."""

    def __init__(self, environment: Mapping[str, str], log: Callable[[str], None]) -> None:
        self._environment, self._log = environment, log
        self._lock = asyncio.Lock()
        self._holders = 0
        self._process: asyncio.subprocess.Process | None = None
        self._link: asyncio.StreamWriter | None = None
        self._reading: asyncio.Task[None] | None = None
        self._address = ("", 0)

    @asynccontextmanager
    async def hold(self) -> AsyncIterator[tuple[str, int]]:
        """Keep the process running while the context lasts, and yield its loopback address.

        Raises ViewerProcessError.
        """
        self._holders += 1
        try:
            async with self._lock:
                if self._process is None or self._process.returncode is not None:
                    await self._end()
                    await self._start()
            yield self._address
        finally:
            self._holders -= 1
            async with self._lock:
                if not self._holders:
                    await self._end()

    async def _start(self) -> None:
        ours, its = socket.socketpair()
        self._process = process = await start_child(
            (*node_command(self._environment), _MODULE), (its,), self._environment
        )
        reader, self._link = await asyncio.open_connection(sock=ours)
        self._reading = asyncio.create_task(read_errors(process, lambda line: self._log(f"viewers: {line}")))
        try:
            line = await asyncio.wait_for(reader.readline(), _START_LIMIT)
            address = read_json(line, _Address)
        except (OSError, ValueError, asyncio.TimeoutError):
            await self._end()
            raise ViewerProcessError("the topics of the robot cannot be offered; see web.log") from None
        self._address = address.host, address.port

    async def _end(self) -> None:
        """End the process by closing its socket."""
        process, self._process = self._process, None
        if self._link is not None:
            self._link.close()
            self._link = None
        if process is None:
            return
        await wait_or_kill(process)
        if self._reading is not None:
            await asyncio.gather(self._reading, return_exceptions=True)
