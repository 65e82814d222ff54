"""The start of a node on ROS 1, until its end; user errors become one clear line instead of a traceback."""

import contextlib
import logging
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from types import FrameType, TracebackType

import rospy

from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.ports.node import Node
from ur_nodes.ros1.node import RosNode
from ur_nodes.ros1.repairs.connections import bound_connections
from ur_nodes.ros1.repairs.logs import choose_log_configuration, discard_line, report_log_errors
from ur_nodes.ros1.repairs.sending import send_at_once

_OURS = "ur_nodes"
_END_LIMIT = 10.0  # s


def end_on_failure() -> threading.Event:
    """Shut the node down when an exception ends a thread that ran a module of ours.

    The traceback goes to the node's log file, one line to standard error. A hook that is set already stays. Returns an
    event that is set when a thread has failed.
    """
    failed = threading.Event()
    before = threading.excepthook
    if before is not threading.__excepthook__:
        return failed

    def end(failure: threading.ExceptHookArgs) -> None:
        if failure.exc_type is SystemExit or rospy.is_shutdown():
            return
        if not _is_ours(failure.exc_traceback):
            before(failure)
            return
        name = failure.thread.name if failure.thread else "a thread"
        text = "".join(traceback.format_exception(failure.exc_type, failure.exc_value, failure.exc_traceback))
        logging.getLogger(_OURS).error("thread %s failed\n%s", name, text)
        problem = f"{failure.exc_type.__name__}: {failure.exc_value}"
        failed.set()
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.write(f"error: {rospy.get_name()}: thread '{name}' failed and ends the node: {problem}\n")
        overdue = threading.Timer(_END_LIMIT, os._exit, (1,))
        overdue.daemon = True
        overdue.start()
        rospy.signal_shutdown(f"thread {name} failed")

    threading.excepthook = end
    return failed


def _is_ours(trace: TracebackType | None) -> bool:
    """Return whether a traceback passes through a module of ours. rospy's own threads may fail and do no harm."""
    while trace is not None:
        if str(trace.tb_frame.f_globals.get("__name__", "")).partition(".")[0] in (_OURS, "__main__"):
            return True
        trace = trace.tb_next
    return False


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
    choose_log_configuration()
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
        signal.signal(signal.SIGINT, _leave)
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


def _leave(_number: int, _frame: FrameType | None) -> None:
    """End the process after rospy's shutdown, which rospy's handler makes first.

    During a shutdown that another signal has begun, rospy's handler makes none: what stops the motors may still wait.
    """
    if rospy.is_shutdown():
        os._exit(128 + signal.SIGINT)


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
