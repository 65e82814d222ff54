"""A node whose main thread belongs to its user interface, not to rospy."""

from __future__ import annotations

import logging
import os
import signal
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import rosgraph
import rospkg
import rospy

from ur.source.crash import EXIT_CODE, describe_crash, write_crash_report
from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.rosio.connections import bound_connections
from ur_nodes.rosio.log_errors import report_log_errors, say_nothing
from ur_nodes.rosio.shell import silence_terminal

BROKEN_PIPE_EXIT_CODE = 128 + signal.SIGPIPE


def run_in_foreground(name: str, body: Callable[[threading.Event], int]) -> int:
    """Register as `name` and call `body(ended)` in this thread; its result is the exit code.

    `ended` is set by SIGINT, SIGTERM, SIGHUP and by the master asking for shutdown: the body returns soon after.
    Without a master, or after a UserError: one clear line on standard error and exit code 2. After any other
    exception, also of another thread: one line that names the file with the traceback, and `crash.EXIT_CODE`.
    When nobody reads the output any more: nothing is printed, and the exit code is that of SIGPIPE, 141.
    When a new node of the same name takes this one's place: one line, and exit code 1. rospy never writes on the
    terminal.
    """
    bound_connections()
    if not rosgraph.is_master_online():
        uri = os.environ.get("ROS_MASTER_URI", "(ROS_MASTER_URI is not set)")
        sys.stderr.write(f"error: {name}: no ROS master at {uri}, expected a running one\n")
        sys.stderr.write("  help: 'ur run' and 'roslaunch' start one, 'roscore' does too\n")
        return 2
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _setter(ended))
    logging.lastResort = None  # Python's handler of last resort writes to standard error, where the screen is
    crashes = collect_thread_crashes()
    try:
        rospy.init_node(name, disable_signals=True)
        report_log_errors(say_nothing)
        silence_terminal()
        reasons: list[str] = []

        def end(reason: str) -> None:  # not by on_shutdown, whose callbacks come before the reason is told
            reasons.append(reason)
            ended.set()

        rospy.core.add_preshutdown_hook(end)
        code = body(ended)
        if crashes:
            raise crashes[0]
        if any("new node registered" in reason for reason in reasons):
            sys.stderr.write(f"error: {name}: ended, because another node registered as {rospy.get_name()}\n")
            sys.stderr.write("  help: __name:=OTHER_NAME lets two of them run side by side\n")
            return 1
        return code
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics))
        return 2
    except BrokenPipeError:
        drop_output()
        return BROKEN_PIPE_EXIT_CODE
    except Exception as problem:
        report = write_crash_report(problem, name, [Path(rospkg.get_log_dir())])
        sys.stderr.write(describe_crash(problem, name, report) + "\n")
        return EXIT_CODE
    finally:
        rospy.signal_shutdown("the program ended")


def drop_output() -> None:
    """Let what is still written to standard output vanish, so that Python does not fail to flush it at the end."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.close(nothing)


def collect_thread_crashes() -> list[BaseException]:
    """Collect the exceptions that end threads from now on; Python would print them where the screen is."""
    crashes: list[BaseException] = []

    def on_crash(details: threading.ExceptHookArgs) -> None:
        if details.exc_value is not None and not isinstance(details.exc_value, SystemExit):
            crashes.append(details.exc_value)

    threading.excepthook = on_crash
    return crashes


def _setter(ended: threading.Event) -> Callable[[int, FrameType | None], None]:
    def on_signal(_number: int, _frame: FrameType | None) -> None:
        ended.set()

    return on_signal
