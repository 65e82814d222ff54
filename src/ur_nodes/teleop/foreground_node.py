"""A node whose main thread belongs to its user interface, not to rospy."""

from __future__ import annotations

import logging
import os
import signal
import sys
import threading
from collections.abc import Callable
from types import FrameType

import rosgraph
import rospy

from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.rosio.shell import silence_terminal


def run_in_foreground(name: str, body: Callable[[threading.Event], int]) -> int:
    """Register as `name` and call `body(ended)` in this thread; its result is the exit code.

    `ended` is set by SIGINT, SIGTERM, SIGHUP and by the master asking for shutdown: the body returns soon after.
    Without a master, or after a UserError: one clear line on standard error and exit code 2. rospy never writes on
    the terminal.
    """
    if not rosgraph.is_master_online():
        uri = os.environ.get("ROS_MASTER_URI", "(ROS_MASTER_URI is not set)")
        sys.stderr.write(f"error: {name}: no ROS master at {uri}, expected a running one\n")
        sys.stderr.write("  help: 'ur run' and 'roslaunch' start one, 'roscore' does too\n")
        return 2
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _setter(ended))
    logging.lastResort = None  # Python's own last word goes to standard error, where the screen is
    rospy.init_node(name, disable_signals=True)
    silence_terminal()
    rospy.on_shutdown(ended.set)
    try:
        return body(ended)
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics))
        return 2
    finally:
        rospy.signal_shutdown("the program ended")


def _setter(ended: threading.Event) -> Callable[[int, FrameType | None], None]:
    def on_signal(_number: int, _frame: FrameType | None) -> None:
        ended.set()

    return on_signal
