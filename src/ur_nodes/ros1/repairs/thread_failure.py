"""The end of a node in which a thread has failed, so that it is restarted and does not run without that thread."""

from __future__ import annotations

import logging
import os
import sys
import threading
import traceback
from types import TracebackType

import rospy

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
        sys.stderr.write(f"error: {rospy.get_name()}: thread '{name}' failed and ends the node: {problem}\n")
        failed.set()
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
