"""The wire between the computers: wire PORT ..., with orders on standard input, a line of JSON each.

Every Ethernet frame of a port goes to all others. Between the first port, the robot's, and the others it is lost or
late as ordered: {"state": "open" | "cut" | "held", "delay": s, "loss": share, "multicast": bool}. What is held leaves
when the wire opens, all at once, as from a radio whose queue was blocked.
"""

import contextlib
import fcntl
import heapq
import itertools
import json
import os
import random
import select
import socket
import struct
import sys
import time
from dataclasses import dataclass, field
from typing import Any

_ALL = 0x0003  # ETH_P_ALL
_ETHTOOL, _SET_CHECKSUMS, _SET_OFFLOAD = 0x8946, 0x17, 0x2C  # ioctl(2): SIOCETHTOOL, ETHTOOL_STXCSUM, ETHTOOL_SGSO
_LARGEST = 65536
_MOST_HELD = 20_000  # frames


@dataclass
class Wire:
    """Frames on their way: those that are due at a time, and those that wait for an order."""

    ports: list[socket.socket]
    state: str = "open"
    delay: float = 0.0
    loss: float = 0.0
    multicast: bool = True
    due: list[tuple[float, int, int, bytes]] = field(default_factory=list)
    held: list[tuple[int, bytes]] = field(default_factory=list)
    numbers: "itertools.count[int]" = field(default_factory=itertools.count)
    chance: random.Random = field(default_factory=lambda: random.Random(1))

    def order(self, given: dict[str, Any]) -> None:
        """Obey an order."""
        for name, value in given.items():
            setattr(self, name, value)
        if self.state == "open":
            for port, frame in self.held:
                self._send(port, frame)
        if self.state != "held":
            self.held.clear()
        if self.state == "cut":
            self.due.clear()

    def take(self, source: int, frame: bytes) -> None:
        """Take a frame of a port."""
        if not self.multicast and frame[0] & 1 and frame[:6] != b"\xff" * 6:
            return
        for target in range(len(self.ports)):
            if target == source:
                continue
            if 0 not in (source, target) or (self.state == "open" and not self.delay and not self.loss):
                self._send(target, frame)
            elif self.state == "held":
                if len(self.held) < _MOST_HELD:
                    self.held.append((target, frame))
            elif self.state == "open" and self.chance.random() >= self.loss:
                heapq.heappush(self.due, (time.monotonic() + self.delay, next(self.numbers), target, frame))

    def deliver(self) -> float:
        """Let frames leave that are due; return the time (s) until the next one is."""
        while self.due and self.due[0][0] <= time.monotonic():
            _, _, target, frame = heapq.heappop(self.due)
            self._send(target, frame)
        return self.due[0][0] - time.monotonic() if self.due else 1.0

    def _send(self, port: int, frame: bytes) -> None:
        with contextlib.suppress(OSError):
            self.ports[port].send(frame)


def open_port(name: str) -> socket.socket:
    """A socket for all frames of an interface."""
    port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(_ALL))
    port.bind((name, _ALL))
    port.setblocking(False)
    return port


def complete_checksums(name: str) -> None:
    """Have the kernel of an interface write checksums itself, as no network card does it here."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        for what in (_SET_OFFLOAD, _SET_CHECKSUMS):
            value = bytearray(struct.pack("II", what, 0))
            place = struct.pack("16sP", name.encode(), _address(value))
            fcntl.ioctl(control, _ETHTOOL, place)


def _address(value: bytearray) -> int:
    import ctypes

    return ctypes.addressof((ctypes.c_char * len(value)).from_buffer(value))


def main(names: list[str]) -> None:
    """Run until standard input ends."""
    wire = Wire([open_port(name) for name in names])
    rest = b""
    while True:
        wait = max(0.0, wire.deliver())
        waiting: list[Any] = [0, *wire.ports]
        for ready in select.select(waiting, [], [], wait)[0]:
            if ready == 0:
                data = os.read(0, 65536)
                if not data:
                    return
                *lines, rest = (rest + data).split(b"\n")
                for line in lines:
                    wire.order(json.loads(line))
                continue
            try:
                frame, address = ready.recvfrom(_LARGEST)
            except BlockingIOError:
                continue
            if address[2] != socket.PACKET_OUTGOING:
                wire.take(wire.ports.index(ready), frame)


if __name__ == "__main__":
    if sys.argv[1] == "--checksums":
        complete_checksums(sys.argv[2])
    else:
        main(sys.argv[1:])
