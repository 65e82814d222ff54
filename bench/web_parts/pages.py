"""Pages that hold the stick: ours, a rude one that never lets go, and one of a plain bridge. Each command is unique."""

import asyncio
import json
import time
from contextlib import suppress
from typing import Any

import aiohttp

SLOWEST, STEP, MOST = 0.2, 2e-5, 10000
GAP = 0.3  # s, as in drive_socket.js


class Page:
    """Answers each challenge with a command while the stick is held. `sent`: the time of each command by its number.

    A page of ours lets go after a gap, as `static/drive_socket.js`; a `rude` one holds on. `plain` sends commands 50
    times a second without any challenge, as pages of plain bridges do.
    """

    def __init__(self, session: aiohttp.ClientSession, url: str, *, rude: bool = False, plain: bool = False) -> None:
        self._session, self._url, self._rude, self._plain = session, url, rude, plain
        self.sent: dict[int, float] = {}
        self.held = False
        self._direction = 1.0
        self._hold = 0
        self._newest_at = 0.0
        self._socket: Any = None
        self._task: asyncio.Task[None] | None = None

    async def open(self) -> None:
        """Connect, and begin to answer."""
        origin = {"Origin": self._url.split("/ws")[0]}
        self._socket = await self._session.ws_connect(self._url, headers=origin)
        self._task = asyncio.create_task(self._beat() if self._plain else self._answer())

    def press(self) -> None:
        """Hold the stick."""
        self._hold += 1
        self.held = True
        self._newest_at = time.monotonic()

    async def let_go(self) -> None:
        """Let go of the stick."""
        self.held = False
        with suppress(ConnectionError):
            await self._socket.send_str(json.dumps({"t": "let_go", "hold": self._hold}))

    async def close(self) -> None:
        """Be gone, without a word."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
        if self._socket is not None:
            with suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._socket.close(), 1.0)

    def turn_round(self) -> None:
        """Drive the other way from now on."""
        self._direction = -self._direction

    async def _answer(self) -> None:
        with suppress(ConnectionError):
            async for message in self._socket:
                if message.type is not aiohttp.WSMsgType.TEXT:
                    return
                challenge = json.loads(message.data).get("n")
                now = time.monotonic()
                if challenge is None:
                    continue
                if self.held and not self._rude and now - self._newest_at > GAP:
                    await self.let_go()
                self._newest_at = now
                if self.held:
                    await self._send({"t": "stick", "n": challenge, "hold": self._hold, "turn": 0.0})

    async def _beat(self) -> None:
        with suppress(ConnectionError):
            while True:
                if self.held:
                    await self._send({})
                await asyncio.sleep(0.02)

    async def _send(self, command: dict[str, Any]) -> None:
        number = len(self.sent) % MOST
        self.sent[number] = time.monotonic()
        await self._socket.send_str(json.dumps({**command, "forward": self._direction * (SLOWEST + number * STEP)}))


def number_of(forward: float) -> int:
    """The number of the command with this velocity."""
    return round((abs(forward) - SLOWEST) / STEP)
