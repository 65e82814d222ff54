"""The frame of a node: start it, run it, and turn user errors into one clear line instead of a traceback."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

import rospy

from ur.source.diagnostic import UserError
from ur.source.render import render_human


def run_node(name: str, start: Callable[[], None], *, own_terminal: bool = False) -> int:
    """Register with the master as `name` (remappable), call `start`, spin until shutdown.

    `start` creates publishers, subscribers and timers and returns. A UserError from it ends the node with the
    diagnostics on standard error and exit code 2. With `own_terminal` rospy never writes to the terminal.
    Returns the exit code.
    """
    if own_terminal:
        os.environ.pop("ROSCONSOLE_CONFIG_FILE", None)
    try:
        rospy.init_node(name, disable_signals=False)
        if own_terminal:
            silence_terminal()
        start()
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
    return 0


def silence_terminal() -> None:
    """Take rospy's handlers off the terminal; its log file and /rosout keep everything."""
    import logging

    for logger in (logging.getLogger("rosout"), logging.getLogger()):
        for handler in list(logger.handlers):
            if type(handler).__name__ == "RosStreamHandler" or type(handler) is logging.StreamHandler:
                logger.removeHandler(handler)
