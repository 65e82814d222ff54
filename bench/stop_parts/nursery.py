"""Nodes that start in a tenth of a second: a process that has imported them already, and copies itself on demand.

A node that dies by SIGKILL must start anew for each trial, and importing takes longer than the trial. What runs is the
node's own `main`, with a command line and standard input as if it had been started by roslaunch. Each notes when it
published each velocity, just before it did.
"""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import json
import os
import signal
import socket
import struct
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

_STAMP = struct.Struct("=d")
_PR_SET_PDEATHSIG = 1


class Child:
    """A node that was born here."""

    def __init__(self, pid: int, stamps: Path) -> None:
        self.pid = pid
        self._stamps = stamps

    def signal(self, number: int) -> None:
        """Send it a signal; one that is gone already does not mind."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.pid, number)

    def last_sent(self) -> float:
        """When it sent its last velocity: seconds of the wall clock; 0 when it never did."""
        data = self._stamps.read_bytes() if self._stamps.exists() else b""
        whole = len(data) // _STAMP.size
        return float(_STAMP.unpack_from(data, (whole - 1) * _STAMP.size)[0]) if whole else 0.0


class Nursery:
    """Make one before threads and rospy are started. `close` ends everybody who was born here."""

    def __init__(self, modules: Sequence[str], folder: Path) -> None:
        """`modules` are imported once; `folder` takes what the nodes write."""
        self._folder = folder
        self._count = 0
        ours, theirs = socket.socketpair()
        self._pid = os.fork()
        if self._pid == 0:
            ours.close()
            with contextlib.suppress(KeyboardInterrupt):
                _serve(theirs, modules, folder)
            os._exit(0)
        theirs.close()
        self._talk = ours.makefile("rw")

    def bear(self, module: str, *arguments: str, terminal: str = "") -> Child:
        """Start `main` of a module with a command line; on a terminal of that path, if one is given."""
        self._count += 1
        stamps = self._folder / f"stamps-{self._count}"
        order = {"module": module, "arguments": arguments, "terminal": terminal, "stamps": str(stamps)}
        self._talk.write(json.dumps(order) + "\n")
        self._talk.flush()
        answer = self._talk.readline()
        if not answer:
            raise SystemExit(f"bench/stop: the nursery is gone; its nodes wrote {self._folder / 'nodes.log'}")
        return Child(int(answer), stamps)

    def close(self) -> None:
        """End it and its children."""
        with contextlib.suppress(OSError):
            self._talk.close()
        with contextlib.suppress(ProcessLookupError, ChildProcessError):
            os.kill(self._pid, signal.SIGKILL)
            os.waitpid(self._pid, 0)


def _serve(orders: socket.socket, modules: Sequence[str], folder: Path) -> None:
    _die_with_parent()
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the children
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    log = os.open(folder / "nodes.log", os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    nothing = os.open(os.devnull, os.O_RDONLY)
    for source, target in ((nothing, 0), (log, 1), (log, 2)):
        os.dup2(source, target)
    for module in modules:
        importlib.import_module(module)
    lines = orders.makefile("rw")
    while line := lines.readline():
        order = json.loads(line)
        pid = os.fork()
        if pid == 0:
            orders.close()
            _live(order)
        lines.write(f"{pid}\n")
        lines.flush()


def _live(order: dict[str, Any]) -> None:
    """Be the node; never returns."""
    code = 1
    try:
        _die_with_parent()
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        if order["terminal"]:
            terminal = os.open(order["terminal"], os.O_RDWR | os.O_NOCTTY)
            os.dup2(terminal, 0)
            os.dup2(terminal, 1)
        sys.argv = [order["module"], *order["arguments"]]
        sys.modules["rospy"].names.reload_mappings(sys.argv)  # it has read them when it was imported
        _note_velocities(order["stamps"])
        code = sys.modules[order["module"]].main()
    except BaseException:
        import traceback

        traceback.print_exc()  # for the log of this bench
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def _note_velocities(path: str) -> None:
    import rospy
    from geometry_msgs.msg import Twist

    file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    publish = rospy.Publisher.publish

    def note_and_publish(self: Any, *arguments: Any, **named: Any) -> None:
        if self.data_class is Twist:
            os.write(file, _STAMP.pack(time.time()))
        publish(self, *arguments, **named)

    rospy.Publisher.publish = note_and_publish


def _die_with_parent() -> None:
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
