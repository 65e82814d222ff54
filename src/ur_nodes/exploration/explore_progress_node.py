"""The program `explore_progress`: the state of an exploration as lines on a terminal or in a log, until it ends."""

from __future__ import annotations

import signal
import sys
import threading
import time

import rospy
from std_msgs.msg import String

from ur_nodes.exploration.status import Status, describe_status, read_status
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.teleop.terminal.foreground_node import run_in_foreground

_NAME = "explore_progress"
_POLL = 0.1  # s


def main() -> int:
    """Print until the exploration or the program ends; see `exit_code`."""
    return run_in_foreground(_NAME, _run)


def _run(ended: threading.Event) -> int:
    every = Parameters().number("print_every", 10.0, minimum=0.5, maximum=3600.0)
    newest: list[Status] = []

    def take(message: String) -> None:
        status = read_status(message.data)
        if status is not None:
            newest[:] = [status]

    rospy.Subscriber("status", String, take, queue_size=1)
    shown, shown_at = "", -every
    while not ended.wait(_POLL):
        if not newest:
            continue
        status = newest[0]
        if status.ended:
            break
        if status.state != shown or time.monotonic() - shown_at >= every:
            shown, shown_at = status.state, time.monotonic()
            _write(describe_status(status))
    return _finish(newest[0] if newest else Status())


def _finish(status: Status) -> int:
    """Print how the exploration has ended and where its map is; return the exit code."""
    if not status.ended:
        left = f"; {status.reachable} frontiers left, about {status.unknown:.0f} m2 unknown" if status.known else ""
        _write(f"stopped before the map was complete{left}")
    else:
        _write(describe_status(status))
    if status.saved:
        _write(f"the map is stored as '{status.saved}'; navigate on it with")
        _write(f"    ur run keyboard_navigate map:={status.saved}")
    else:
        sys.stderr.write(f"error: {_NAME}: no map is stored, expected one of this exploration\n")
    return exit_code(status)


def exit_code(status: Status) -> int:
    """0: complete, and saved. 1: it ended by itself before that. 130: somebody ended it."""
    if not status.ended or status.state == "stopped":
        return 128 + signal.SIGINT
    return 0 if status.state == "complete" and status.saved else 1


def _write(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
