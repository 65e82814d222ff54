"""The process that offers topics to Foxglove: started for the first viewer, ended after the last one."""

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

from ur.source.foreign.json_values import read_json
from ur.system.child_processes import NodeProcess, start_node

_MODULE = "ur_nodes.web.viewers.viewer_endpoint_node"
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
        self._node: NodeProcess | None = None
        self._address = ("", 0)

    @asynccontextmanager
    async def hold(self) -> AsyncIterator[tuple[str, int]]:
        """Keep the process running while the context lasts, and yield its loopback address.

        Raises ViewerProcessError.
        """
        self._holders += 1
        try:
            async with self._lock:
                if self._node is None or self._node.process.returncode is not None:
                    await self._end()
                    await self._start()
            yield self._address
        finally:
            self._holders -= 1
            async with self._lock:
                if not self._holders:
                    await self._end()

    async def _start(self) -> None:
        self._node = await start_node(_MODULE, self._environment, lambda line: self._log(f"viewers: {line}"))
        try:
            line = await asyncio.wait_for(self._node.links[0][0].readline(), _START_LIMIT)
            address = read_json(line, _Address)
        except (OSError, ValueError, asyncio.TimeoutError):
            await self._end()
            raise ViewerProcessError("the topics of the robot cannot be offered; see web.log") from None
        self._address = address.host, address.port

    async def _end(self) -> None:
        node, self._node = self._node, None
        if node is not None:
            await node.close()
