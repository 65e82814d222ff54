"""The process that talks to ROS: started when a master answers, and restarted when it has ended."""

import asyncio
import json
import os
import socket
from collections import deque
from collections.abc import AsyncIterator, Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Literal
from urllib.parse import urlsplit

from ur.run.host.protocol import FORKS, SESSION, receive, send
from ur.run.join.decision import read_claims
from ur.run.record.registry import RunEntry, list_runs, read_computer
from ur.source.foreign.json_values import read_json
from ur.source.printable import one_line
from ur.source.run_users import PAGE, forget_user, note_user
from ur.system.child_processes import ForkedProcess, Process, start_child, start_node
from ur.system.ros import NONE, graph_address, read_domain, viewer_socket
from ur.web.wire.frames import LENGTH, LONGEST, NOTHING_RUNS

State = Literal["no master", "starting", "up"]
"""`no master`: nothing runs, whether there is a master or not."""
_MODULE = "ur_nodes.web.robot_endpoint_node"
_MASTER_LIMIT = 2.0  # s
_FORK_LIMIT = 20.0  # s: a run that has just started imports the modules of its nodes first
_PAUSE = 1.0  # s
_REFUSALS = 2  # connections in a row, after which the master has ended
_DRIVE_LINE = 1 << 16  # bytes
_PRINTED = 20  # last lines of the process that are kept
_LONGEST_ERROR = 300  # characters


class RobotProcess:
    """Keeps the process running until `run` is cancelled. Its frames and messages are passed to callbacks.

    `on_start` is called after each start, before its first frame; `on_state` after `state` has changed.
    """

    def __init__(
        self,
        environment: Mapping[str, str],
        on_frame: Callable[[bytes], None],
        on_message: Callable[[Mapping[str, object]], None],
        on_start: Callable[[], None],
        on_state: Callable[[], None],
        log: Callable[[str], None],
    ) -> None:
        self._environment = environment
        self._on_frame, self._on_message = on_frame, on_message
        self._on_start, self._on_state, self._log = on_start, on_state, log
        self._view: asyncio.StreamWriter | None = None
        self._drive: asyncio.StreamWriter | None = None
        self.state: State = "no master"
        self.problem = ""
        """The error with which the last process has ended; empty while one is connected, or ended without."""
        self._printed: deque[str] = deque(maxlen=_PRINTED)
        self.pid = 0

    @property
    def master(self) -> str:
        """The address of the master."""
        return graph_address(self._environment)

    def send(self, message: Mapping[str, object]) -> None:
        """Forward a message of a page; it is dropped while the process is not running."""
        if self._drive is not None:
            self._drive.write(json.dumps(message, separators=(",", ":")).encode() + b"\n")

    def look(self, viewers: int, layers: Collection[int], plots: Collection[str] = (), camera: str = "") -> None:
        """Send the process the number of pages, their layers and plots, and the topic of the chosen camera."""
        if self._view is not None:
            value = {"viewers": viewers, "layers": sorted(layers), "plots": sorted(plots), "camera": camera}
            self._view.write(json.dumps(value).encode() + b"\n")
        # Inform the runs of this computer that end with the robot's loss whether pages show it
        for run in self._base_runs():
            if not viewers:
                forget_user(run.folder, PAGE)
                continue
            with suppress(OSError):  # the process is ending
                note_user(run.folder, PAGE)

    def _base_runs(self) -> list[RunEntry]:
        """Return the runs of this computer and master that have the base of the robot."""
        runs = list_runs(self._environment, os.getuid(), read_computer())
        master = self.master.rstrip("/")
        return [run for run in runs if run.master_uri.rstrip("/") == master and read_claims(run.folder).base]

    async def run(self) -> None:
        """Start the process whenever a master answers and it is not running."""
        while True:
            if await self._master_answers():
                self._enter("starting")
                await self._run_once()
                self._enter("starting")
            else:
                self._enter("no master")
            await asyncio.sleep(_PAUSE)

    def _enter(self, state: State) -> None:
        if state != self.state:
            self.state = state
            self._on_state()

    async def _await_end_of_master(self) -> None:
        """Return when nothing listens at the master's address any more; a computer out of reach may come back."""
        refused = 0
        while refused < _REFUSALS:
            await asyncio.sleep(_PAUSE)
            refused = 0 if await self._master_answers(unknown=True) else refused + 1

    async def _master_answers(self, *, unknown: bool = False) -> bool:
        """Determine whether a master answers. `unknown`: what to return for a computer that does not."""
        if (domain := read_domain(self.master)) is not None:
            return domain != NONE or Path(viewer_socket(self._environment)).exists()  # there is no master to wait for
        address = urlsplit(self.master)
        try:
            opened = asyncio.open_connection(address.hostname, address.port or 11311)
            _, writer = await asyncio.wait_for(opened, _MASTER_LIMIT)
        except ConnectionRefusedError:
            return False
        except (OSError, ValueError, asyncio.TimeoutError):
            return unknown
        writer.close()
        return True

    async def _run_once(self) -> None:
        node = await start_node(
            _MODULE, self._environment, self._take_error, self._fork_or_start, links=2, longest=_DRIVE_LINE
        )
        self.pid = node.process.pid
        (frames, self._view), (messages, self._drive) = node.links
        tasks = [
            asyncio.create_task(self._take_frames(frames)),
            asyncio.create_task(self._read_messages(messages)),
            asyncio.create_task(self._await_end_of_master()),
        ]
        try:
            self._on_start()
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._view = self._drive = None
            for task in tasks:
                task.cancel()
            await node.close()
            await asyncio.gather(*tasks, return_exceptions=True)
            self.problem = find_error(self._printed) if node.process.returncode else ""

    async def _fork_or_start(
        self, command: Sequence[str], ends: Sequence[socket.socket], environment: Mapping[str, str]
    ) -> Process:
        """Let a run that has just started fork the node, which then shares the memory of its nodes; else execute it."""
        for run in self._base_runs():
            ours, theirs = socket.socketpair()
            with theirs, suppress(OSError, EOFError):
                files = tuple(each.fileno() for each in (*ends, theirs))
                pid = await asyncio.to_thread(fork_node, f"{run.folder}/{FORKS}", command[-1], files, environment)
                for each in ends:
                    each.close()
                return ForkedProcess(pid, *await asyncio.open_connection(sock=ours))
            ours.close()
        return await start_child(command, ends, environment)

    async def _take_frames(self, reader: asyncio.StreamReader) -> None:
        async for frame in read_frames(reader):
            self.problem = ""
            self._enter("no master" if frame == NOTHING_RUNS else "up")
            if frame != NOTHING_RUNS:
                self._on_frame(frame)

    async def _read_messages(self, reader: asyncio.StreamReader) -> None:
        with suppress(ConnectionError, ValueError):
            while line := await reader.readline():
                self._on_message(read_json(line, dict[str, object], _DRIVE_LINE))

    def _take_error(self, text: str) -> None:
        self._printed.append(text)
        self._log(text)


def fork_node(path: str, module: str, files: tuple[int, ...], environment: Mapping[str, str]) -> int:
    """Have `ur_nodes.fork_server` fork a node with two sockets and standard error; return its process id.

    Raises OSError and EOFError: that process has ended.
    """
    with socket.socket(socket.AF_UNIX) as server:
        server.settimeout(_FORK_LIMIT)
        server.connect(path)
        send(server, ("", [module, "0", "1"], "/", {**environment, "ROS_NAMESPACE": None}, SESSION), files)
        (_, pid), (gate,) = receive(server)
    with os.fdopen(gate, "wb", 0) as opener:
        opener.write(b"1")
    return int(pid)


async def read_frames(reader: asyncio.StreamReader) -> AsyncIterator[bytes]:
    """Yield the frames of a node until the connection ends, or one is too long."""
    with suppress(asyncio.IncompleteReadError, ConnectionError):
        while True:
            (length,) = LENGTH.unpack(await reader.readexactly(LENGTH.size))
            if length > LONGEST:
                return
            yield await reader.readexactly(length)


def find_error(lines: Iterable[str]) -> str:
    """Return the error in the last lines of a process, with its help; else its last line. At most 300 characters."""
    found = ""
    for line in map(one_line, lines):
        if line.startswith("error: ") or not found.startswith("error: "):
            found = line or found
        elif line.startswith("help: "):
            found += f"; {line}"
    return found[:_LONGEST_ERROR]


def robot_environment() -> dict[str, str]:
    """Return the environment of the process: that of this one, without variables that would rename its node."""
    left_out = ("ROS_NAMESPACE", "ROSCONSOLE_CONFIG_FILE")
    return {name: value for name, value in os.environ.items() if name not in left_out}
