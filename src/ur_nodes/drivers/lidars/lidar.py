"""The shape of a driver of a lidar: a class that turns bytes into beams."""

from collections.abc import Iterable, Iterator
from typing import Protocol

from ur_nodes.drivers.frames import FrameReader
from ur_nodes.drivers.readings import Reading


class LidarProtocol(Protocol):
    """The protocol of one kind of lidar. Nothing here waits, reads a clock, or opens a device."""

    name: str
    """For messages, as "RPLIDAR"."""
    baud: int
    dtr: bool
    """The level of the modem line DTR, which switches the motors of some adapters."""

    @property
    def rejected(self) -> int:
        """Pieces that began as a frame and were none since the start: damaged ones, and noise."""

    def handshake(self) -> bytes:
        """Return what is sent once the line is open, and again while the device does not answer."""

    def shutdown(self) -> bytes:
        """Return what is sent at the end: the lidar stops turning, where there is a command for it."""

    def receive(self, data: bytes) -> Iterable[Reading]:
        """Receive bytes as they arrive, and return the readings that they complete. No bytes make it raise."""


def time_on_line(size: int, baud: int) -> float:
    """The time (s) that so many bytes take on a serial line, 10 bits each."""
    return 10.0 * size / baud


def join_frames(frames: list[bytes], most: int) -> Iterator[bytes]:
    """Join frames of one length, at most so many, so that they are decoded together: less than a turn."""
    for at in range(0, len(frames), most):
        yield b"".join(frames[at : at + most])


class SendingLidar:
    """A lidar that measures whenever it has power, and listens to nothing."""

    _frames: FrameReader

    @property
    def rejected(self) -> int:
        return self._frames.rejected

    def handshake(self) -> bytes:
        return b""

    def shutdown(self) -> bytes:
        return b""
