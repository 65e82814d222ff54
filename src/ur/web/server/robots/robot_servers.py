"""Servers for other robots: started when a page requests one, and ended with this server."""

from __future__ import annotations

import asyncio
import socket
import sys
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from urllib.parse import urlsplit

from ur.robot.discovery.masters import RobotMaster
from ur.source.foreign.json_values import convert_json
from ur.system.child_processes import read_errors, start_child, wait_or_kill
from ur.system.ros import graph_address
from ur.web.access.roles import Role
from ur.web.server.robots.peer import LONGEST_LINE, Handler, Peer, PeerError
from ur.web.server.robots.robots import RobotEntry, ServerLogin, write_rows

LIMIT = 1.0
_FRESH = 3.0  # s for which a result is valid
_THREADS = 8  # a name may take longer to resolve than the limit

MOST = 8
"""Servers that run at the same time."""

_START_LIMIT = 30.0  # s
_OLD_VARIABLES = ("ROS_NAMESPACE",)


class RobotServers:
    """The robots that this computer knows. `own` is the one that this server shows, so it needs no other server."""

    def __init__(
        self,
        own: str,
        known: Callable[[], Sequence[RobotMaster]],
        own_place: Callable[[Role], ServerLogin],
        options: Sequence[str],
        environment: Mapping[str, str],
        log: Callable[[str], None],
    ) -> None:
        """Manage servers for the robots that `known` lists.

        `options` of `ur web` are those of every server: they contain no secret.
        """
        self.own = own
        self._known, self._own_place, self._options = known, own_place, options
        self._environment, self._log = environment, log
        self._check = MastersCheck()
        self._servers: dict[str, _Server] = {}
        self._starts = asyncio.Lock()
        self._closed = False

    async def list(self) -> list[RobotEntry]:
        """List the robots, and check their masters."""
        known = await self._read()
        masters = {each.name: self._master_of(each) for each in known}
        answering = await self._check.check(list(dict.fromkeys(masters.values())))
        return [
            RobotEntry(each.name, label_of(each), masters[each.name] in answering, self._is_open(each.name))
            for each in known
        ]

    async def invite(self, name: str, role: Role) -> ServerLogin:
        """Start a server for a listed robot if necessary, and create a token of a role for it. Raises PeerError."""
        if name == self.own:
            return self._own_place(role)
        robot = next((each for each in await self._read() if each.name == name), None)
        if robot is None:
            raise PeerError("this robot is not in the list")
        server = await self._find_or_start(robot)
        token = await server.peer.ask({"invite": role.value})
        self._log(f"makes a link that may {role.value} to the page of {robot.name}")
        return ServerLogin(server.port, str(token))

    async def close(self) -> None:
        """End the servers."""
        self._closed = True
        self._check.close()
        servers = list(self._servers.values())
        for each in servers:
            each.peer.close()
        await asyncio.gather(*(each.ended for each in servers))

    async def _read(self) -> Sequence[RobotMaster]:
        return await asyncio.get_running_loop().run_in_executor(None, self._known)

    def _master_of(self, robot: RobotMaster) -> str:
        """Return the robot's master; for the own robot that of the environment, which the user may have set."""
        own = {"ROS_MASTER_URI": robot.master, **self._environment}
        return graph_address(own) if robot.name == self.own else robot.master

    def _is_open(self, name: str) -> bool:
        return name == self.own or name in self._servers

    async def _find_or_start(self, robot: RobotMaster) -> _Server:
        async with self._starts:
            server = self._servers.get(robot.name)
            if server is not None and not server.peer.ended:
                return server
            if server is not None:  # its last page was closed long ago
                await server.ended
            if self._closed:
                raise PeerError("this server ends")
            if len(self._servers) >= MOST:
                raise PeerError(f"{MOST} other robots are open, close the pages of one: its server ends after 10 min")
            return await self._start(robot)

    async def _start(self, robot: RobotMaster) -> _Server:
        environment = {name: value for name, value in self._environment.items() if name not in _OLD_VARIABLES}
        environment["ROS_MASTER_URI"] = robot.master
        ours, its = socket.socketpair()
        command = (sys.executable, "-I", "-m", "ur", "web", robot.selection, "--no-browser", *self._options, "--child")
        process = await start_child(command, (its,), environment)
        reader, writer = await asyncio.open_connection(sock=ours, limit=LONGEST_LINE)
        server = self._servers[robot.name] = _Server(process, reader, writer, self._handle, self._log)

        def forget(_ended: asyncio.Future[None]) -> None:
            if self._servers.get(robot.name) is server:
                del self._servers[robot.name]
            self._log(f"the server of {robot.name} has ended")

        server.ended.add_done_callback(forget)
        if self._closed:
            server.peer.close()
        try:
            await asyncio.wait({server.ended, server.ready}, timeout=_START_LIMIT, return_when="FIRST_COMPLETED")
            if not server.ready.done() or server.ended.done():
                server.peer.close()
                await server.ended
                raise PeerError(server.problem or f"the server of {robot.name} does not start, see the log of 'ur web'")
        except asyncio.CancelledError:
            server.peer.close()
            raise
        self._log(f"the server of {robot.name} runs on port {server.port}")
        return server

    async def _handle(self, request: Mapping[str, object]) -> object:
        """Answer a child server: the list, or the login to another robot."""
        if "open" in request:
            return asdict(await self.invite(str(request["open"]), Role(request["role"])))
        return write_rows(await self.list())


class _Server:
    """A child server, until its process has ended."""

    def __init__(
        self,
        process: asyncio.subprocess.Process,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
        handle: Handler,
        log: Callable[[str], None],
    ) -> None:
        self._process, self._handle, self._log = process, handle, log
        self.peer = Peer(reader, writer, self._answer)
        self.ready: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self.port = 0
        self.problem = ""
        self.ended = asyncio.ensure_future(self._run())

    async def _answer(self, request: Mapping[str, object]) -> object:
        if "ready" not in request:
            return await self._handle(request)
        self.port = convert_json(request["ready"], int)
        if not self.ready.done():
            self.ready.set_result(None)
        return None

    async def _run(self) -> None:
        errors = asyncio.create_task(read_errors(self._process, self._take_error))
        try:
            await self.peer.run()
        finally:
            await wait_or_kill(self._process)
            await errors

    def _take_error(self, text: str) -> None:
        self._log(text)
        if not self.problem and text.startswith("error: "):
            self.problem = text.removeprefix("error: ")[:200]


def label_of(robot: RobotMaster) -> str:
    """Return the display name of a robot."""
    return "simulated robot" if robot.simulated else robot.name


"""Seconds that a master has to answer."""


class MastersCheck:
    """Checks whether masters answer, by their URIs. Nothing is sent between calls of `check`."""

    def __init__(self, ask: Callable[[str], bool] | None = None, limit: float = LIMIT) -> None:
        self._ask, self._limit = ask or answers, limit
        self._threads = ThreadPoolExecutor(_THREADS, "masters")
        self._found: dict[str, tuple[float, bool]] = {}
        self._running: dict[str, asyncio.Future[None]] = {}

    async def check(self, masters: Collection[str]) -> frozenset[str]:
        """Return the masters that answered within the limit."""
        for master in masters:
            at = self._found.get(master, (float("-inf"), False))[0]
            if master not in self._running and time.monotonic() - at > _FRESH:
                self._running[master] = asyncio.ensure_future(self._check_one(master))
        waiting = [self._running[each] for each in masters if each in self._running]
        if waiting:
            await asyncio.wait(waiting, timeout=self._limit)
        return frozenset(
            each for each in masters if each not in self._running and self._found.get(each, (0.0, False))[1]
        )

    def close(self) -> None:
        """End the checks."""
        for task in self._running.values():
            task.cancel()
        self._threads.shutdown(wait=False, cancel_futures=True)

    async def _check_one(self, master: str) -> None:
        try:
            found = await asyncio.get_running_loop().run_in_executor(self._threads, self._ask, master)
            self._found[master] = time.monotonic(), found
        finally:
            del self._running[master]


def answers(master: str) -> bool:
    """Return whether the port of a master accepts a connection within the limit."""
    try:
        address = urlsplit(master)
        with socket.create_connection((address.hostname or "", address.port or 11311), LIMIT):
            return True
    except (OSError, ValueError):
        return False
