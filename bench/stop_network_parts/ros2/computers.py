"""The computers: network namespaces on a wire, and their processes, which go before all others of this machine."""

import contextlib
import json
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from bench.stop_network_parts.computer import Waits, put_first

ADDRESSES = {"robot": "10.231.8.1", "laptop": "10.231.8.2", "laptop2": "10.231.8.3"}
_WIRE = "bench.stop_network_parts.ros2.wire"
_PATIENCE = 10.0  # s
_FRESH = 0.15  # s: an older command is late


@dataclass(slots=True)
class Program:
    """A program on a computer; what it prints goes to a file."""

    name: str
    process: subprocess.Popen[bytes]

    def send(self, number: int) -> None:
        """Send it a signal."""
        with contextlib.suppress(ProcessLookupError):
            self.process.send_signal(number)

    def order(self, text: str) -> None:
        """Write a line to it."""
        assert self.process.stdin
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.write(text.encode() + b"\n")
            self.process.stdin.flush()

    def end(self) -> None:
        """End it."""
        self.send(signal.SIGCONT)
        self.send(signal.SIGKILL)
        self.process.wait(_PATIENCE)
        if self.process.stdin:
            with contextlib.suppress(BrokenPipeError):
                self.process.stdin.close()


@dataclass(slots=True)
class Computers:
    """Runs programs on computers, and sets the wire. `holders` are the processes that keep the namespaces."""

    folder: Path
    environment: Mapping[str, str]
    holders: dict[str, subprocess.Popen[bytes]]
    programs: list[Program] = field(default_factory=list)
    waits: Waits = field(default_factory=Waits)
    _orders: dict[str, Any] = field(default_factory=dict)
    wire: Program | None = None
    blocked: list[tuple[float, float]] = field(default_factory=list)
    """Intervals (monotonic s) in which what is sent does not arrive while it is fresh; the last may be open."""

    def start(self, side: str, name: str, command: Sequence[str], more: Mapping[str, str] | None = None) -> Program:
        """Start a program on a computer, before all other programs of this machine."""
        wrapped = ["nsenter", f"--net=/proc/{self.holders[side].pid}/ns/net", "--", *command]
        environment = {**self.environment, **(more or {})}
        first = partial(_go_first, 1 if side.startswith("laptop") else 2)
        with (self.folder / f"{name}.txt").open("ab") as output:
            process = subprocess.Popen(
                wrapped, env=environment, stdin=subprocess.PIPE, stdout=output, stderr=output, preexec_fn=first
            )
        program = Program(name, process)
        self.programs.append(program)
        return program

    def end(self, program: Program) -> None:
        """End a program."""
        program.end()
        self.programs.remove(program)

    def order(self, **orders: Any) -> None:
        """Set the wire."""
        assert self.wire
        self._orders |= orders
        now = time.monotonic()
        late = self._orders.get("state", "open") != "open" or self._orders.get("delay", 0.0) > _FRESH
        if late and not self._is_blocked():
            self.blocked.append((now, math.inf))
        elif not late and self._is_blocked():
            self.blocked[-1] = (self.blocked[-1][0], now - _FRESH)
        self.wire.order(json.dumps(orders))

    def can_arrive(self, at: float) -> bool:
        """Return whether a command that was sent at a time could arrive while it was fresh."""
        return not any(begin < at < end for begin, end in self.blocked)

    def _is_blocked(self) -> bool:
        return bool(self.blocked) and self.blocked[-1][1] == math.inf

    def close(self) -> None:
        """End everything."""
        for program in reversed(self.programs):
            with contextlib.suppress(subprocess.TimeoutExpired):
                program.end()
        for holder in self.holders.values():
            holder.kill()
            holder.wait()

    def on(self, side: str, *command: str) -> None:
        """Run a command on a computer."""
        wrapped = ["nsenter", f"--net=/proc/{self.holders[side].pid}/ns/net", "--", *command]
        subprocess.run(wrapped, check=True, capture_output=True, text=True, env=dict(self.environment))

    def join(self, side: str) -> None:
        """Connect a computer with the wire."""
        module = [sys.executable, "-m", _WIRE, "--checksums"]
        port = f"to_{side}"
        self.on("wire", "ip", "link", "add", "name", port, "type", "veth", "peer", "name", "wlan0")
        self.on("wire", "ip", "link", "set", "wlan0", "netns", str(self.holders[side].pid))
        self.on("wire", "ip", "link", "set", port, "up")
        self.on("wire", *module, port)
        self.on(side, *module, "wlan0")
        self.on(side, "ip", "address", "add", f"{ADDRESSES[side]}/24", "dev", "wlan0")
        self.on(side, "ip", "link", "set", "wlan0", "up")
        self.on(side, "ip", "link", "set", "lo", "up")


@contextlib.contextmanager
def start_computers(folder: Path, environment: Mapping[str, str]) -> Iterator[Computers]:
    """A robot and two laptops on a wire. Needs root."""
    hold = ["unshare", "--net", "--", "sh", "-c", "echo; exec sleep infinity"]
    holders = {side: subprocess.Popen(hold, stdout=subprocess.PIPE) for side in ("wire", *ADDRESSES)}
    computers = Computers(folder, environment, holders)
    try:
        for holder in holders.values():
            assert holder.stdout
            holder.stdout.readline()  # it is in its namespace
        for side in ADDRESSES:
            computers.join(side)
        ports = [f"to_{side}" for side in ADDRESSES]
        computers.wire = computers.start("wire", "wire", [sys.executable, "-m", _WIRE, *ports])
        yield computers
    finally:
        computers.close()


def wait_for(condition: Any, seconds: float, what: str) -> None:
    """Wait until a condition is true. Raises RuntimeError: it took too long."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise RuntimeError(f"waited for {seconds:g} s: {what}")
        time.sleep(0.05)


def _go_first(priority: int) -> None:
    put_first([os.getpid()], priority)
