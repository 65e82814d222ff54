"""The parent server, which has started this one: it lists and opens the robots, and this server ends with it."""

import asyncio
import socket
import time
from collections.abc import Callable, Mapping

from ur.source.diagnostic import UserError, error
from ur.source.foreign.json_values import convert_json
from ur.web.access.roles import Role
from ur.web.server.robots.peer import LONGEST_LINE, Peer, PeerError
from ur.web.server.robots.robots import RobotEntry, ServerLogin

IDLE_LIMIT = 600.0
"""Seconds after which a server that no page is connected to ends."""

_CHECKED_EVERY = 2.0  # s


class ParentServer:
    """The parent's end of the socket. `own` is the name of the robot that this server shows."""

    def __init__(self, own: str, connection: socket.socket, invite: Callable[[Role], str]) -> None:
        self.own = own
        self._connection, self._invite = connection, invite
        self._peer: Peer | None = None
        self._idle = Idle(time.monotonic())

    async def run(self, port: int, is_connected: Callable[[], bool]) -> None:
        """Report the port, and serve until the parent server has ended, or no page was connected for IDLE_LIMIT."""
        reader, writer = await asyncio.open_connection(sock=self._connection, limit=LONGEST_LINE)
        self._peer = Peer(reader, writer, self._answer)
        serving = asyncio.create_task(self._peer.run())
        try:
            await self._peer.ask({"ready": port})
            while not serving.done() and not self._idle.is_over(time.monotonic(), connected=is_connected()):
                await asyncio.wait({serving}, timeout=_CHECKED_EVERY)
        except PeerError:  # the connection is just ending
            pass
        finally:
            serving.cancel()
            await asyncio.gather(serving, return_exceptions=True)

    async def list(self) -> list[RobotEntry]:
        """List the robots."""
        return convert_json(await self._ask({"list": True}), list[RobotEntry])

    async def invite(self, name: str, role: Role) -> ServerLogin:
        """Start a server for a listed robot if necessary, and create a token of a role for it. Raises PeerError."""
        if name == self.own:
            raise PeerError("this page shows this robot")
        return convert_json(await self._ask({"open": name, "role": role.value}), ServerLogin)

    async def close(self) -> None:
        """Do nothing: the parent server has started all servers."""

    async def _ask(self, request: Mapping[str, object]) -> object:
        if self._peer is None:
            raise PeerError("this server has just been started, try again")
        return await self._peer.ask(request)

    async def _answer(self, request: Mapping[str, object]) -> object:
        """Create a token for one login."""
        self._idle.note(time.monotonic())
        return self._invite(Role(request["invite"]))


class Idle:
    """The time since a page was connected or invited. All times are in s."""

    def __init__(self, now: float) -> None:
        self._last = now

    def note(self, now: float) -> None:
        """Record that a page was connected or invited."""
        self._last = now

    def is_over(self, now: float, *, connected: bool) -> bool:
        """Return whether no page was connected for IDLE_LIMIT."""
        if connected:
            self.note(now)
        return now - self._last > IDLE_LIMIT


def adopt_connection(descriptor: int) -> socket.socket:
    """Take over the socket that the parent server has passed. Raises UserError if it is not a socket."""
    try:
        connection = socket.socket(fileno=descriptor)
        if connection.family != socket.AF_UNIX:
            connection.detach()
            raise OSError
        connection.set_inheritable(False)
        return connection
    except (OSError, ValueError):
        message = f"--child {descriptor}: expected a socket of the server that starts this one"
        help_ = "leave it out: the panel Robots of the page starts servers with it"
        raise UserError(error(message, rule="bad-options", help=help_)) from None
