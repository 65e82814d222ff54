"""The process that reads data of the robot: it runs while a page shows data, separate from the driving process."""

import asyncio
import json
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Literal

from ur.system.child_processes import start_node
from ur.web.server.robot_process import read_frames
from ur.web.wire.data_frames import DataFrame, unpack_frame

_MODULE = "ur_nodes.web.data.data_endpoint_node"
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
        node = await start_node(_MODULE, self._environment, lambda line: self._log(f"data: {line}"))
        self.pid = node.process.pid
        ((reader, link),) = node.links
        self._link = link
        try:
            self._on_start()
            with suppress(ValueError):
                async for body in read_frames(reader):
                    frame = unpack_frame(body)
                    self.state = "up"
                    self._on_frame(frame)
        finally:
            if self._link is link:
                self._link = None
            await asyncio.shield(node.close())
