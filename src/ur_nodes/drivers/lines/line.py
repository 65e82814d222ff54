"""The line to a device, as drivers know it: bytes both ways, opened again and again while the device is not there."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

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
