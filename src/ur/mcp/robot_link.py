"""The robot's end as the server reaches it: calls with answers, and signs of life."""

import asyncio
import contextlib
import json
import os
from collections.abc import Callable, Mapping
from typing import Protocol

from ur.source.foreign.json_values import read_json
from ur.system.child_processes import NodeProcess, PendingAnswers, start_node

_MODULE = "ur_nodes.assistant.assistant_endpoint_node"
_LINE = 1 << 26  # bytes
_START_LIMIT = 20.0  # s

Values = Mapping[str, object]


class RobotLink(Protocol):
    """Sends messages to the robot's end. `on_revoked` is called with the reason when another client took over.

    `challenge` is the newest of the mux, while a call drives; 0 before the first.
    """

    challenge: int
    on_revoked: Callable[[str], None]

    async def ask(self, message: Values, limit: float) -> Values:
        """Send a message, and wait for its answer for so long (s). Raises LinkError."""

    def send(self, message: Values) -> None:
        """Send a message that has no answer."""


class LinkError(Exception):
    """The robot's end does not answer; the text says why."""


class ProcessLink:
    """See RobotLink: a process of the robot's middleware, started by the first message, and again when it has ended."""

    def __init__(self, environment: Mapping[str, str], log: Callable[[str], None]) -> None:
        self._environment, self._log = environment, log
        self._answers = PendingAnswers[Values](LinkError)
        self._writer: asyncio.StreamWriter | None = None
        self._node: NodeProcess | None = None
        self._reading: asyncio.Task[None] | None = None
        self._starting = asyncio.Lock()
        self.challenge = 0
        self.on_revoked: Callable[[str], None] = lambda _: None

    async def ask(self, message: Values, limit: float) -> Values:
        await self._start()
        number, answer = self._answers.add()
        self.send({**message, "id": number})
        try:
            return await asyncio.wait_for(answer, limit)
        except asyncio.TimeoutError:
            raise LinkError(
                "the robot does not answer; does a program run on it ('ur run keyboard_navigate')?"
            ) from None

    def send(self, message: Values) -> None:
        if self._writer is not None and not self._writer.is_closing():
            self._writer.write(json.dumps(message, separators=(",", ":")).encode() + b"\n")

    async def close(self) -> None:
        """End the process, which ends every motion first."""
        if self._node is not None and self._reading is not None:
            await self._node.close()
            self._reading.cancel()
            await asyncio.gather(self._reading, return_exceptions=True)

    async def _start(self) -> None:
        async with self._starting:
            if self._writer is not None and not self._writer.is_closing():
                return
            self._node = await start_node(_MODULE, self._environment, self._log, longest=_LINE)
            ((reader, self._writer),) = self._node.links
            self._reading = asyncio.create_task(self._read(reader))

    async def _read(self, reader: asyncio.StreamReader) -> None:
        with contextlib.suppress(ConnectionError, ValueError):
            while line := await reader.readline():
                message = read_json(line, dict[str, object], _LINE)
                if "revoked" in message:
                    self.on_revoked(str(message["revoked"]))
                elif isinstance(challenge := message.get("challenge"), int):
                    self.challenge = challenge
                else:
                    self._answers.give(message.get("id"), message)
        if self._writer is not None:
            self._writer.close()
        self._answers.fail("the connection to the robot has ended; does a program run on it?")


def robot_environment(environment: Mapping[str, str] = os.environ) -> dict[str, str]:
    """The environment of the process: that of this one, without what would name another node or client."""
    left_out = ("ROS_NAMESPACE", "ROSCONSOLE_CONFIG_FILE", "UR_CLIENT", "UR_LEASE")
    return {name: value for name, value in environment.items() if name not in left_out}
