"""The pace of frames: work that is due now and then, and frames that a slow server gets fewer of."""

import math
from collections.abc import Callable, Iterable
from typing import Protocol

from ur_nodes.ports.node import Node

Frames = Callable[[], Iterable[bytes]]
"""Makes frames; it is called beside the node."""

_LANE = "frames"


class FrameOutlet(Protocol):
    """Sends frames without letting the node wait."""

    busy: bool
    """Return whether the server has not taken all that was sent: what can be left out now should be."""

    def send_frame(self, frame: bytes) -> None:
        """Send a frame."""


class FrameSender:
    """Makes frames on a worker, and sends them in the order of `put`."""

    def __init__(self, node: Node, outlet: FrameOutlet) -> None:
        self._node, self._outlet = node, outlet
        self._making = 0

    @property
    def busy(self) -> bool:
        """Return whether frames are still on their way: a server that is slow gets fewer."""
        return self._making > 0 or self._outlet.busy

    def put(self, frames: Frames) -> None:
        """Make frames on a worker, then send them."""
        self._making += 1
        self._node.work(lambda: list(frames()), self._send, _LANE)

    def _send(self, frames: list[bytes]) -> None:
        self._making -= 1
        for each in frames:
            self._outlet.send_frame(each)


class Every:
    """Work that is due at once, then once in a number of seconds; a late step does not delay later ones."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._next = -math.inf

    def due(self, now: float) -> bool:
        """Return whether the work is due, and if so count it as done. `now` is `Node.steady`."""
        late = now - self._next
        if late < 0.0:
            return False
        self._next = (self._next if late < self._seconds else now) + self._seconds
        return True

    def hurry(self) -> None:
        """Make the work due at once."""
        self._next = -math.inf
