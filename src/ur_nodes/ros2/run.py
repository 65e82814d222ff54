"""The start of a node on ROS 2."""

import faulthandler
import os
import signal
import sys
import threading
from collections.abc import Callable
from pathlib import Path

from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.ports.node import Node
from ur_nodes.ros2.attached import attach

_LEAVE = 10.0  # s
_PROFILES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")


def run(name: str, start: Callable[[Node], object], *, own_terminal: bool = False) -> int:
    """Run a node until it ends; see `ur_nodes.run.run`."""
    ended = threading.Event()
    failures: list[threading.ExceptHookArgs] = []

    def fail(details: threading.ExceptHookArgs) -> None:
        threading.__excepthook__(details)
        failures.append(details)
        ended.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda _number, _frame: ended.set())
    threading.excepthook = fail
    if not any(each in os.environ for each in _PROFILES):
        os.environ[_PROFILES[0]] = str(Path(__file__).with_name("fast_dds.xml"))
    try:
        with attach(name, start, ended.set, quiet=own_terminal) as (_wired, node):
            node.leaving = limit_shutdown
            ended.wait()
        return int(node.failed or bool(failures))
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics))
        return 2


def limit_shutdown(seconds: float = _LEAVE) -> None:
    """End this process with exit code 1 if it has not ended in so many seconds.

    Threads of Fast DDS can deadlock when many nodes leave a domain at once. Python's lock is held then, so neither a
    thread nor a signal handler of Python could end the process.
    """
    _unread, nowhere = os.pipe()
    faulthandler.dump_traceback_later(seconds, exit=True, file=nowhere)
