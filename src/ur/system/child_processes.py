"""Child processes of a server: connected by sockets, their errors in its log, ended with it."""

import asyncio
import itertools
import os
import shutil
import signal
import socket
from collections.abc import Awaitable, Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from typing import Generic, TypeVar

from ur.system.ros import node_command

Answer = TypeVar("Answer")
_END_LIMIT = 5.0  # s
_PAUSE = 0.05  # s


class PendingAnswers(Generic[Answer]):
    """Requests to another process that wait for an answer, by their numbers. `failure` makes the error of one."""

    def __init__(self, failure: Callable[[str], Exception]) -> None:
        self._failure = failure
        self._waiting: dict[object, asyncio.Future[Answer]] = {}
        self._numbers = itertools.count(1)

    def add(self) -> tuple[int, asyncio.Future[Answer]]:
        """Return a new number, and the answer to come."""
        number, future = next(self._numbers), asyncio.get_running_loop().create_future()
        self._waiting[number] = future
        future.add_done_callback(lambda _: self._waiting.pop(number, None))
        return number, future

    def give(self, number: object, answer: Answer, problem: str | None = None) -> None:
        """Give an answer, or the problem in place of it, to the request of a number, if that still waits."""
        future = self._waiting.get(number)
        if future is None or future.done():
            return
        if problem is None:
            future.set_result(answer)
        else:
            future.set_exception(self._failure(problem))

    def fail(self, reason: str) -> None:
        """Answer nothing any more."""
        for each in list(self._waiting.values()):
            if not each.done():
                each.set_exception(self._failure(reason))


def end_with_us(by: str = "INT") -> list[str]:
    """Return the command prefix that signals a process when this process is killed: prctl(2), PR_SET_PDEATHSIG."""
    return ["setpriv", "--pdeathsig", by, "--"] if shutil.which("setpriv") else []


async def start_child(
    command: Sequence[str], ends: Sequence[socket.socket], environment: Mapping[str, str]
) -> asyncio.subprocess.Process:
    """Start a process with sockets, whose descriptors are its last arguments; they are then closed in this process.

    It is to end when they are closed. It is interrupted when this process is killed, since it may not read them yet: a
    node that registers with a master which has ended waits for that.
    """
    with ExitStack() as stack:
        descriptors = tuple(stack.enter_context(each).fileno() for each in ends)
        return await asyncio.create_subprocess_exec(
            *(*end_with_us(), *command, *map(str, descriptors)),
            pass_fds=descriptors,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
            env=dict(environment),
            start_new_session=True,  # Ctrl-C is for this process, which ends that one
        )


@dataclass(slots=True)
class ForkedProcess:
    """A process that another one has forked for this one. `writer` belongs to the reader of its errors."""

    pid: int
    stderr: asyncio.StreamReader
    writer: asyncio.StreamWriter
    returncode: int = 0  # only its parent knows it

    async def wait(self) -> None:
        """Wait for its end."""
        while os.path.exists(f"/proc/{self.pid}"):  # noqa: PTH110 - as short
            await asyncio.sleep(_PAUSE)
        self.writer.close()

    def kill(self) -> None:
        """Send SIGKILL."""
        os.kill(self.pid, signal.SIGKILL)


Process = asyncio.subprocess.Process | ForkedProcess


@dataclass(slots=True)
class NodeProcess:
    """A node that is connected by sockets, and ends when they are closed."""

    process: Process
    links: list[tuple[asyncio.StreamReader, asyncio.StreamWriter]]
    _errors: asyncio.Task[None]

    async def close(self) -> None:
        """End it, and wait for its last errors."""
        for _, writer in self.links:
            writer.close()
        await wait_or_kill(self.process)
        await asyncio.gather(self._errors, return_exceptions=True)


async def start_node(
    module: str,
    environment: Mapping[str, str],
    log: Callable[[str], None],
    start: Callable[..., Awaitable[Process]] = start_child,
    *,
    links: int = 1,
    longest: int = 1 << 16,
) -> NodeProcess:
    """Start a module of `ur_nodes` with sockets. `log` gets its errors; a line that is read has `longest` bytes."""
    pairs = [socket.socketpair() for _ in range(links)]
    process = await start((*node_command(environment), module), [its for _, its in pairs], environment)
    opened = [await asyncio.open_connection(sock=ours, limit=longest) for ours, _ in pairs]
    return NodeProcess(process, opened, asyncio.create_task(read_errors(process, log)))


async def read_errors(process: Process, callback: Callable[[str], None]) -> None:
    """Pass on each line of a process's errors until it ends."""
    assert process.stderr is not None
    with suppress(ValueError):
        while line := await process.stderr.readline():
            callback(line.decode("utf-8", "replace").rstrip())


async def wait_or_kill(process: Process, limit: float = _END_LIMIT) -> None:
    """Wait for a process that is about to end, and kill it after `limit` s."""
    try:
        await asyncio.wait_for(process.wait(), limit)
    except asyncio.TimeoutError:
        with suppress(ProcessLookupError):
            process.kill()
        await process.wait()
