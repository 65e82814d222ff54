"""The line to a device, as drivers know it: bytes both ways, opened again and again while the device is not there."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Generic, Protocol, TypeVar

from ur_nodes.ports.node import Node

_PAUSE = 0.5  # s between two attempts to open it


class Closable(Protocol):
    """A thing that is closed in the end."""

    def close(self) -> None:
        """Close it."""


Port = TypeVar("Port", bound=Closable)
Answer = TypeVar("Answer")


@dataclass(frozen=True, slots=True)
class PolledUser:
    """The calls of a polled device, on the node's thread: it is open, and it was lost (a new reason)."""

    opened: Callable[[], None]
    lost: Callable[[str], None]


class PolledDevice(Generic[Port]):
    """`ask` does nothing while the device is not open, and while it still answers."""

    def __init__(self, node: Node, name: str, opening: Callable[[], Port | str], user: PolledUser) -> None:
        """`opening` opens the device named `name`, or returns why it cannot; it may block."""
        self._node, self._name, self._opening, self._user = node, name, opening, user
        self._port: Port | None = None
        self._works = False
        self._reported = ""
        node.on_end(self._end)
        self._open()

    def ask(self, job: Callable[[Port], Answer | str], callback: Callable[[Answer, int], None]) -> None:
        """Run a job with the device on a worker; `callback` gets its result and the time (ns) at its end.

        A text is why the device is lost.
        """
        if self._port is None or self._works:
            return
        self._works = True
        timed = partial(_run, job, self._port, self._node.now)
        self._node.work(timed, partial(self._on_result, callback), self._name)

    def _on_result(self, callback: Callable[[Answer, int], None], result: tuple[Answer | str, int]) -> None:
        self._works = False
        answer, now = result
        if isinstance(answer, str):
            port, self._port = self._port, None
            if port is not None:
                port.close()
            self._lose(answer)
        else:
            callback(answer, now)

    def _open(self) -> None:
        self._node.work(self._opening, self._on_port, self._name)

    def _on_port(self, opened: Port | str) -> None:
        if isinstance(opened, str):
            self._lose(opened)
            return
        self._port, self._reported = opened, ""
        self._user.opened()

    def _lose(self, reason: str) -> None:
        if reason != self._reported:
            self._reported = reason
            self._user.lost(reason)
        self._node.after(_PAUSE, self._open, steady=True)

    def _end(self) -> None:
        if self._port is not None:
            self._node.work(self._port.close, _ignore, self._name)  # after the job that still has it


def _ignore(_: None) -> None: ...


def _run(job: Callable[[Port], Answer], port: Port, now: Callable[[], int]) -> tuple[Answer, int]:
    return job(port), now()


REPORT = 10.0
"""Seconds between two lines for people on one problem of a device."""


@dataclass(frozen=True, slots=True)
class LineUser:
    """The calls of a line, on the node's thread: it is open, bytes arrived (stamp, ns), it was lost (the reason)."""

    opened: Callable[[], None]
    received: Callable[[bytes, int], None]
    lost: Callable[[str], None]


@dataclass(frozen=True, slots=True)
class LineSettings:
    """The speed of a line, and the level of its modem line DTR.

    `stop` are bytes that stop the motors when this process no longer can; b'' for a device without motors that drive.
    `shutdown` are those that leave the device when this process has died. `batch` is the time (s) in which bytes
    that arrive one after the other are collected: what reads less often takes less of the processor.
    """

    baud: int
    stop: bytes = b""
    dtr: bool = True
    shutdown: bytes = b""
    batch: float = 0.002


class DeviceLine(Protocol):
    """A line that may be open."""

    name: str
    """The device file, for messages."""

    def write(self, data: bytes, *, moving: bool = False) -> None:
        """Send bytes; dropped while it is not open. `moving`: motors turn after them, until others are sent."""

    def close(self) -> None:
        """Close it for good, after what was written before has left."""


def describe_loss(line: DeviceLine, reason: str, expected: str) -> str:
    """Describe a line that was lost, or could not be opened."""
    help_ = "plug it in (ur devices lists what is there); it is opened again by itself"
    return f"{line.name}: {reason}; expected {expected}; {help_}"


def explain_error(problem: Exception) -> str:
    """The reason of an error of the operating system, also of termios.error."""
    number = problem.errno if isinstance(problem, OSError) else problem.args[0] if problem.args else None
    return os.strerror(number).lower() if isinstance(number, int) else str(problem)


Connect = Callable[[LineUser, LineSettings], DeviceLine]
"""Makes a line for a user."""
