"""The start of a node on the middleware of this computer."""

import logging
import os
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from importlib import import_module
from pathlib import Path
from typing import TypeVar

from ur_nodes.ports.node import Node

Wired = TypeVar("Wired")

BROKEN_PIPE_EXIT_CODE = 128 + signal.SIGPIPE


def run(name: str, start: Callable[[Node], object], *, own_terminal: bool = False) -> int:
    """Start a node under a name that can be remapped, and run it until it ends. Returns the exit code.

    `start` wires it up; what it returns lives as long as the node. A UserError from it ends the node with its
    diagnostics on standard error and exit code 2, an exception in a callback with exit code 1. With `own_terminal`
    nothing else writes to the terminal.
    """
    backend = import_module(f"ur_nodes.{backend_name()}.run")  # ROS is loaded for nodes that run
    code: int = backend.run(name, start, own_terminal=own_terminal)
    return code


def run_foreground(name: str, start: Callable[[Node], Wired], body: Callable[[Wired, threading.Event], int]) -> int:
    """Run a node beside a user interface that has this thread. Returns the exit code: what `body` returns.

    `start` wires the node up, before its callbacks begin. `body` gets what it returned, and an event that is set by
    SIGINT, SIGTERM, SIGHUP, the end of the node and an exception in a callback: it then returns soon. `body` reads
    frozen values of the node, and reaches the node with `Node.post` only. Nothing else writes to the terminal.

    A UserError, also because no middleware runs: its diagnostics on standard error, exit code 2. Any other exception,
    also of a callback: one line that names the file with the traceback, `crash.EXIT_CODE`. The output is no longer
    read: nothing is printed, 141, that of SIGPIPE. Another node takes this one's name: one line, 1.
    """
    from ur.source.crash import EXIT_CODE, describe_crash, write_crash_report
    from ur.source.diagnostic import UserError
    from ur.source.render import render_human

    backend = import_module(f"ur_nodes.{backend_name()}.attached")
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda _number, _frame: ended.set())
    logging.lastResort = None  # Python's handler of last resort writes to standard error, where the screen is
    crashes = _collect_crashes(ended)
    try:
        with backend.attach(name, start, ended.set) as (wired, node):
            code = body(wired, ended)
            if crashes:
                raise crashes[0]
            if node.replaced:
                sys.stderr.write(f"error: {name}: ended, because another node registered as {node.name}\n")
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
        report = write_crash_report(problem, name, [log_folder()])
        sys.stderr.write(describe_crash(problem, name, report) + "\n")
        return EXIT_CODE


def attach(
    name: str, start: Callable[[Node], Wired], end: Callable[[], None]
) -> AbstractContextManager[tuple[Wired, Node]]:
    """Run a node in a program of a user's, with callbacks on a thread of the node's own, as long as the context.

    `start` wires it up; `end` is called on any thread when the middleware ends the node. Signals stay the program's.
    Raises UserError on entering: no middleware runs.
    """
    backend = import_module(f"ur_nodes.{backend_name()}.attached")
    attached: AbstractContextManager[tuple[Wired, Node]] = backend.attach(name, start, end)
    return attached


def drop_output() -> None:
    """Let what is still written to standard output vanish, so that Python does not fail to flush it at the end."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.close(nothing)


def log_folder() -> Path:
    """The folder of the log files of nodes."""
    return Path(os.environ.get("ROS_LOG_DIR") or Path(os.environ.get("ROS_HOME") or Path.home() / ".ros", "log"))


def find_package(name: str) -> Path | None:
    """The folder with the files of an installed package; None where it is not installed."""
    backend = backend_name()
    if backend == "ros1":
        found: Path | None = import_module("ur_nodes.ros1.packages").find_package(name)
        return found
    variable, place = ("AMENT_PREFIX_PATH", "share") if backend == "ros2" else ("ROS_PACKAGE_PATH", "")
    for prefix in os.environ.get(variable, "").split(os.pathsep):
        folder = Path(prefix, place, name)
        if prefix and name and "/" not in name and folder.is_dir():
            return folder
    return None


def backend_name() -> str:
    """The middleware by ROS_VERSION, of the set-up file that was used last; `ur` sets 0 where there is none."""
    return {"0": "one_process", "2": "ros2"}.get(os.environ.get("ROS_VERSION", ""), "ros1")


def own_arguments(arguments: Sequence[str]) -> list[str]:
    """The arguments of a program that are its own, without those that remap names and set parameters."""
    given = list(arguments)
    own = given[: given.index("--ros-args")] if "--ros-args" in given else given
    return [each for each in own if ":=" not in each]


def _collect_crashes(ended: threading.Event) -> list[BaseException]:
    """Collect the exceptions that end threads from now on; Python would print them where the screen is."""
    crashes: list[BaseException] = []

    def on_exception(details: threading.ExceptHookArgs) -> None:
        if details.exc_value is not None and not isinstance(details.exc_value, SystemExit):
            crashes.append(details.exc_value)
            ended.set()

    threading.excepthook = on_exception
    return crashes
