"""Nodes that start in a tenth of a second: a process that has imported them already, and copies itself on demand.

A node that dies by SIGKILL must start anew for each trial, and importing takes longer than the trial. What runs is the
node's own `main`, with a command line and standard input as if it had been started by roslaunch. Each notes when it
published each velocity, and which, just before it did.
"""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import json
import os
import random
import signal
import socket
import struct
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

_STAMP = struct.Struct("=dddd")
_PR_SET_PDEATHSIG = 1
_MIDDLEWARE = ("rospy", "ur_nodes.ros1.run")  # a node imports it when it starts


class Sent(NamedTuple):
    """A velocity that was published: seconds of the wall clock and of the monotonic one, m/s, rad/s."""

    at: float
    monotonic: float
    forward: float
    turn: float


def read_sent(path: Path) -> list[Sent]:
    """All velocities that a node noted in a file; none when there is no file."""
    data = path.read_bytes() if path.exists() else b""
    whole = len(data) - len(data) % _STAMP.size
    return [Sent(*record) for record in _STAMP.iter_unpack(data[:whole])]


class Child:
    """A node that was born here."""

    def __init__(self, pid: int, stamps: Path) -> None:
        self.pid = pid
        self.stamps = stamps

    def signal(self, number: int) -> None:
        """Send it a signal; one that is gone already does not mind."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.pid, number)

    def last_sent(self) -> float:
        """When it sent its last velocity: seconds of the wall clock; 0 when it never did."""
        sent = read_sent(self.stamps)
        return sent[-1].at if sent else 0.0


class Nursery:
    """Make one before threads and rospy are started. `close` ends everybody who was born here."""

    def __init__(self, modules: Sequence[str], folder: Path) -> None:
        """`modules` are imported once; `folder` takes what the nodes write."""
        self._folder = folder
        self._count = 0
        self._lock = threading.Lock()
        ours, theirs = socket.socketpair()
        maker = os.getpid()
        self._pid = os.fork()
        if self._pid == 0:
            ours.close()
            _die_with_parent(maker)
            with contextlib.suppress(KeyboardInterrupt):
                _serve(theirs, modules, folder)
            os._exit(0)
        theirs.close()
        self._talk = ours.makefile("rw")

    def bear(
        self,
        module: str,
        *arguments: str,
        terminal: str = "",
        namespace: str = "",
        name: str = "",
        main: str = "main",
        more: Mapping[str, str] | None = None,
    ) -> Child:
        """Start `main` of a module with a command line in a ROS namespace, on a terminal or pipe of that path if any.

        `name` becomes part of the name of the file with its notes. `main` is another function's name, `more` are
        variables of its environment.
        """
        with self._lock:
            self._count += 1
            stamps = self._folder / f"stamps-{self._count}-{name}"
            order: dict[str, Any] = {
                "module": module,
                "arguments": arguments,
                "terminal": terminal,
                "stamps": str(stamps),
            }
            order |= {"namespace": namespace, "more": dict(more or {}), "main": main}
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
    server = os.getpid()
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the children
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    log = os.open(folder / "nodes.log", os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    nothing = os.open(os.devnull, os.O_RDONLY)
    for source, target in ((nothing, 0), (log, 1), (log, 2)):
        os.dup2(source, target)
    for module in (*_MIDDLEWARE, *modules):
        importlib.import_module(module)
    lines = orders.makefile("rw")
    while line := lines.readline():
        order = json.loads(line)
        pid = os.fork()
        if pid == 0:
            orders.close()
            _die_with_parent(server)
            _live(order)
        lines.write(f"{pid}\n")
        lines.flush()


def _live(order: dict[str, Any]) -> None:
    """Be the node; never returns."""
    code = 1
    try:
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        if order["terminal"]:
            terminal = os.open(order["terminal"], os.O_RDWR | os.O_NOCTTY)
            os.dup2(terminal, 0)
            if os.isatty(terminal):
                os.dup2(terminal, 1)
        sys.argv = [order["module"], *order["arguments"]]
        os.environ |= order["more"]
        random.seed()  # else all children would draw the same numbers
        names = sys.modules["rospy"].names
        names.reload_mappings(sys.argv)  # it has read them when it was imported
        names._set_caller_id(order["namespace"].rstrip("/") + "/unnamed")  # noqa: SLF001 - else read once
        _note_velocities(order["stamps"])
        code = getattr(sys.modules[order["module"]], order["main"])() or 0
    except BaseException:
        import traceback

        traceback.print_exc()  # for the log of this bench
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def _note_velocities(path: str) -> None:
    import rospy
    from geometry_msgs.msg import Twist, TwistStamped

    flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND
    file, beats = os.open(path, flags, 0o600), os.open(f"{path}.beats", flags, 0o600)
    publish = rospy.Publisher.publish

    def note_and_publish(self: Any, *arguments: Any, **named: Any) -> None:
        if self.data_class in (Twist, TwistStamped):
            message = arguments[0] if arguments and isinstance(arguments[0], self.data_class) else None
            twist = message.twist if isinstance(message, TwistStamped) else message
            velocity = (twist.linear.x, twist.angular.z) if twist else (0.0, 0.0)
            os.write(file, _STAMP.pack(time.time(), time.monotonic(), *velocity))
        elif self.resolved_name.endswith("/lease_request"):
            os.write(beats, _STAMP.pack(time.time(), time.monotonic(), 0.0, 0.0))
        publish(self, *arguments, **named)

    rospy.Publisher.publish = note_and_publish  # type: ignore[method-assign]


def _die_with_parent(parent: int) -> None:
    """Have the kernel kill this process when its parent ends; end at once if that has happened already."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it ended between the fork and now, and there is no signal for that
        os._exit(1)
