"""The start of a node on ROS 1, until its end; user errors become one clear line instead of a traceback."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType

import rospy

from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.ports.node import Node
from ur_nodes.ros1.node import RosNode
from ur_nodes.ros1.repairs.connections import bound_connections
from ur_nodes.ros1.repairs.log_errors import discard_line, report_log_errors
from ur_nodes.ros1.repairs.sending import send_at_once
from ur_nodes.ros1.repairs.thread_failure import end_on_failure

_REGISTER_LIMIT = 5  # s that a node which registers with the master has to end


def run(name: str, start: Callable[[Node], object], *, own_terminal: bool = False) -> int:
    """Run a node until it ends; see `ur_nodes.run.run`."""
    nodes: list[RosNode] = []
    wired: list[object] = []

    def begin() -> None:
        node = RosNode()
        nodes.append(node)
        wired.append(start(node))
        node.begin()

    code = run_node(name, begin, own_terminal=own_terminal)
    return code or int(any(node.failed for node in nodes))


def run_node(name: str, start: Callable[[], None], *, own_terminal: bool = False) -> int:
    """Register with the master as `name` (remappable), call `start`, spin until shutdown.

    `start` creates publishers, subscribers and timers and returns. A UserError from it ends the node with the
    diagnostics on standard error and exit code 2, an exception that ends a thread of ours with exit code 1. With
    `own_terminal` rospy never writes to the terminal. Returns the exit code.
    """
    if own_terminal:
        os.environ.pop("ROSCONSOLE_CONFIG_FILE", None)
    bound_connections()
    send_at_once()
    try:
        with shut_down_aside():
            rospy.init_node(name, disable_signals=True)
            report_log_errors(discard_line if own_terminal else None)
            if own_terminal:
                silence_terminal()
            failed = end_on_failure()
            start()
        rospy.core.register_signals()
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics))
        rospy.signal_shutdown("user error")
        return 2
    except rospy.ROSInitException as problem:
        sys.stderr.write(f"error: {name}: cannot start, expected a ROS master: {problem}\n")
        return 2
    except rospy.ROSInterruptException:
        return 0
    rospy.spin()
    return int(failed.is_set())


@contextlib.contextmanager
def shut_down_aside(end: Callable[[str], None] = rospy.signal_shutdown) -> Iterator[None]:
    """While a node registers with the master, let signals shut it down in a thread of its own.

    rospy's handler speaks to the master on the main thread. Where that is in the middle of a call to the master it
    waits for itself for ever: the proxy's lock is held until the call that it interrupts is done. In a thread it waits
    likewise where there is no master, which rospy registers with until it succeeds: the process is ended then.
    """

    def shut_down(number: int, _frame: FrameType | None) -> None:
        signal.alarm(_REGISTER_LIMIT)
        threading.Thread(target=end, args=(f"signal-{number}",), name="shutdown").start()

    before = {number: signal.signal(number, shut_down) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        signal.alarm(0)
        for number, handler in before.items():
            signal.signal(number, handler)


def silence_terminal() -> None:
    """Remove rospy's log handlers of the terminal; its log file and /rosout get all lines."""
    import logging

    for logger in (logging.getLogger("rosout"), logging.getLogger()):
        for handler in list(logger.handlers):
            if type(handler).__name__ == "RosStreamHandler" or type(handler) is logging.StreamHandler:
                logger.removeHandler(handler)
