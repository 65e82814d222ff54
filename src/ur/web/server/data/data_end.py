"""The process that reads data of the robot: it runs while a page shows data, separate from the driving process."""

from __future__ import annotations

import asyncio
import json
import socket
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Literal

from ur.system.child_processes import read_errors, start_child, wait_or_kill
from ur.system.ros import node_command
from ur.web.wire.data_frames import DataFrame, unpack_frame
from ur.web.wire.frames import LENGTH, LONGEST

_MODULE = "ur_nodes.web.data.data_end_node"
_PAUSE = 1.0  # s before it is started again
_WAITING = 1 << 20  # bytes of requests that the process has not read

State = Literal["off", "starting", "up"]


class DataProcess:
    """Keeps the process running between `open` and `close`.

    `on_start` is called before its first frame. `is_up` returns whether the robot is connected: without a master the
    process would not start.
    """

    def __init__(
        self,
        environment: Mapping[str, str],
        is_up: Callable[[], bool],
        on_frame: Callable[[DataFrame], None],
        on_start: Callable[[], None],
        log: Callable[[str], None],
    ) -> None:
        self._environment, self._is_up = environment, is_up
        self._on_frame, self._on_start, self._log = on_frame, on_start, log
        self._link: asyncio.StreamWriter | None = None
        self._task: asyncio.Task[None] | None = None
        self.state: State = "off"
        self.pid = 0

    def open(self) -> None:
        """Keep the process running from now on."""
        if self._task is None:
            self.state = "starting"
            self._task = asyncio.create_task(self._run())

    async def close(self) -> None:
        """End the process."""
        task, self._task = self._task, None
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        if self._task is None:
            self.state = "off"

    def send(self, page: int, text: str) -> bool:
        """Forward a request of a page, or "" when the page has disconnected. Return whether the process accepts it."""
        if self._link is None or self._link.transport.get_write_buffer_size() > _WAITING:
            return False
        self._link.write(json.dumps({"page": page, "m": text}).encode() + b"\n")
        return True

    async def _run(self) -> None:
        while True:
            if self._is_up():
                await self._run_once()
                self.state = "starting"
            await asyncio.sleep(_PAUSE)

    async def _run_once(self) -> None:
        ours, its = socket.socketpair()
        process = await start_child((*node_command(self._environment), _MODULE), (its,), self._environment)
        self.pid = process.pid
        errors = asyncio.create_task(read_errors(process, lambda line: self._log(f"data: {line}")))
        reader, link = await asyncio.open_connection(sock=ours)
        self._link = link
        try:
            self._on_start()
            await self._read_frames(reader)
        finally:
            link.close()
            if self._link is link:
                self._link = None
            await asyncio.shield(_finish(process, errors))

    async def _read_frames(self, reader: asyncio.StreamReader) -> None:
        with suppress(asyncio.IncompleteReadError, ConnectionError, ValueError):
            while True:
                (length,) = LENGTH.unpack(await reader.readexactly(LENGTH.size))
                if length > LONGEST:
                    raise ValueError(f"frame of {length} bytes")
                frame = unpack_frame(await reader.readexactly(length))
                self.state = "up"
                self._on_frame(frame)


async def _finish(process: asyncio.subprocess.Process, errors: asyncio.Task[None]) -> None:
    """Wait for the process, which ends when its socket is closed."""
    await wait_or_kill(process)
    await asyncio.gather(errors, return_exceptions=True)
