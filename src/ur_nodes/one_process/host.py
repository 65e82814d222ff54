"""The process of all nodes of a run: host FILE, where FILE has what `read_plan` reads.

Each node's module runs as it does in a process of its own, on a thread; `ur_nodes.run` finds its `context`. The node
that has the terminal has the main thread, and the process ends with it.
"""

from __future__ import annotations

import logging
import logging.handlers
import os
import runpy
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import NoReturn, TextIO

from ur.source.foreign.json_values import read_json
from ur_nodes.file_facts import FileFacts
from ur_nodes.one_process.bus import LiveBus, LiveNode
from ur_nodes.one_process.context import NodeContext
from ur_nodes.one_process.viewers import ViewerSocket

_MOST = 1 << 26  # bytes


@dataclass(frozen=True, slots=True)
class NodeStart:
    """A node: its full name, the module and its arguments, and full names that replace others."""

    name: str
    words: tuple[str, ...]
    remaps: dict[str, str] = field(default_factory=dict)
    required: bool = False
    respawn: bool = False
    respawn_delay: float = 0.0
    terminal: bool = False


@dataclass(frozen=True, slots=True)
class ProcessPlan:
    """The nodes of a process. `log` takes the nodes' lines where one of them has the terminal.

    `parameters` is the file of all of them, `viewers` the socket at which viewers of this computer ask for nodes.
    """

    name: str
    nodes: tuple[NodeStart, ...]
    log: str
    parameters: str
    viewers: str


def read_plan(path: str) -> ProcessPlan:
    """Read the file. Raises OSError, and ValueError for an invalid file."""
    return read_json(Path(path).read_bytes(), ProcessPlan, _MOST)


def read_parameters(path: str) -> dict[str, object]:
    """Read parameters by their full names. Raises OSError, and ValueError for an invalid file."""
    return read_json(Path(path).read_bytes(), dict[str, object], _MOST)


_LONGEST = 10_000_000  # bytes of a log file; there are two


class NodeOutput:
    """Writes lines of logs: to a file, or where that is empty to the standard output and error, as single nodes do."""

    def __init__(self, file: str) -> None:
        self._file = logging.Logger("nodes")
        if file:
            self._file.addHandler(logging.handlers.RotatingFileHandler(file, maxBytes=_LONGEST, backupCount=1))
        self._kept = bool(file)
        self._out, self._errors = sys.stdout, sys.stderr

    def write_line(self, level: str, node: str, text: str) -> None:
        """Write a line of a node's log."""
        line = f"[{level}] [{time.time():.3f}] [{node}]: {text}"
        if self._kept:
            self._file.warning(line)
            return
        stream = self._out if level == "INFO" else self._errors
        stream.write(line + "\n")
        stream.flush()

    def divert_threads(self) -> None:
        """Divert the output of all threads except the main one to the log, if it is a file."""
        if self._kept:
            sys.stdout = _ThreadStream(sys.stdout, self)
            sys.stderr = _ThreadStream(sys.stderr, self)


class _ThreadStream:
    """A stream of the terminal for the main thread, and a log for others."""

    def __init__(self, stream: TextIO, output: NodeOutput) -> None:
        self._stream, self._output = stream, output

    def write(self, text: str) -> int:
        """Write a text."""
        if threading.current_thread() is threading.main_thread():
            return self._stream.write(text)
        for line in filter(None, text.splitlines()):
            self._output.write_line("INFO", threading.current_thread().name, line)
        return len(text)

    def flush(self) -> None:
        """Flush the terminal."""
        self._stream.flush()

    def __getattr__(self, name: str) -> object:
        return getattr(self._stream, name)


_NODE_LIMIT = 5.0  # s for the end of a node


def start_thread(name: str, run: Callable[[Callable[[], None]], None]) -> threading.Thread:
    """Run on a thread, and return it once it has called the function that it is given."""
    started = threading.Event()
    thread = threading.Thread(target=run, args=(started.set,), name=name, daemon=True)
    thread.start()
    started.wait()
    return thread


class Host:
    """Starts and ends the nodes of a plan."""

    def __init__(self, plan: ProcessPlan) -> None:
        self._plan = plan
        self._output = NodeOutput(plan.log)
        self._bus = LiveBus(FileFacts(simulated_time=False), self._output.write_line)
        for name, value in read_parameters(plan.parameters).items():
            self._bus.load_parameters("", {name.lstrip("/"): value})
        self._arguments = threading.Lock()  # held while sys.argv is that of the module that starts
        self._nodes: list[LiveNode] = []
        self._threads: list[threading.Thread] = []  # of the nodes
        self._over = threading.Event()
        self._code = 0

    def run(self) -> int:
        """Run until a signal, or the end of the node with the terminal or of a required one. Returns the exit code."""
        terminal = next((each for each in self._plan.nodes if each.terminal), None)
        if terminal is None:
            own = self._bus.node(self._plan.name)
            assert isinstance(own, LiveNode)
            own.at_over = self._over.set
        self._bus.held = True  # until all nodes have started
        self._bus.begin()
        viewers = self._listen_for_viewers()
        others = [each for each in self._plan.nodes if not each.terminal]
        try:
            if terminal is None:
                for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                    signal.signal(number, lambda _number, _frame: self._over.set())
                self._start_all(others)
                self._over.wait()
                return self._code or int(self._bus.failed)
            self._output.divert_threads()
            first = threading.Event()
            threading.Thread(target=self._start_all, args=(others, first), name="starts", daemon=True).start()
            return self._run_module(terminal, first.set)
        finally:
            if viewers is not None:
                viewers.close()
            self._end_nodes()
            self._bus.close()

    def _listen_for_viewers(self) -> ViewerSocket | None:
        try:
            return ViewerSocket(self._plan.viewers, self._run_for_viewer)
        except OSError as problem:
            text = f"the page cannot show this run: {self._plan.viewers}: {problem.strerror or problem}"
            self._output.write_line("WARN", self._plan.name, text)
            return None

    def _start_all(self, nodes: Sequence[NodeStart], first: threading.Event | None = None) -> None:
        if first is not None:
            first.wait()
        for node in nodes:
            self._threads.append(start_thread(node.name, partial(self._keep, node)))
        self._bus.held = False

    def _keep(self, start: NodeStart, started: Callable[[], None]) -> None:
        """Run a node, and restart it as the plan requires."""
        while not self._over.is_set():
            code = self._run_module(start, started)
            self._output.write_line("INFO", start.name, f"ended, exit code {code}")
            if start.required and not self._over.is_set():
                self._code = code
                self._over.set()
                # End the node that has the terminal
                for each in self._plan.nodes:
                    if each.terminal and (node := self._bus.nodes.get(each.name)):
                        node.end("a required node has ended")
            if not start.respawn or self._over.wait(start.respawn_delay):
                break
        started()  # the run may end before its first start

    def _run_module(self, start: NodeStart, started: Callable[[], None]) -> int:
        """Run the module of a node on this thread. Returns its exit code."""
        release = _Release(self._arguments, started)
        context = NodeContext(self._bus, start.name, start.remaps, release, self._add)
        return self._run_words(start.words, context, release)

    def _run_for_viewer(self, words: Sequence[str]) -> None:
        """Run a module whose node chooses its name."""
        release = _Release(self._arguments, lambda: None)
        self._run_words(words, NodeContext(self._bus, started=release), release)

    def _run_words(self, words: Sequence[str], context: NodeContext, release: _Release) -> int:
        context.enter()
        self._arguments.acquire()
        try:
            sys.argv = list(words)
            if words[0].endswith(".py"):
                runpy.run_path(words[0], run_name="__main__")
            else:
                runpy.run_module(words[0], run_name="__main__")
        except SystemExit as end:
            return end.code if isinstance(end.code, int) else int(end.code is not None)
        except BaseException:
            for line in traceback.format_exc().splitlines():
                self._output.write_line("ERROR", context.name, line)
            return 1
        finally:
            release()
        return 0

    def _add(self, node: LiveNode) -> None:
        """Note a node that has started; the end of the run may have begun meanwhile."""
        self._nodes.append(node)
        if self._over.is_set():
            self._end_node(node)

    def _end_node(self, node: LiveNode) -> None:
        with suppress(RuntimeError):  # the bus has failed
            self._bus.do(lambda: node.end("the run ends"))

    def _end_nodes(self) -> None:
        """End all nodes in reverse order, so that nodes that drive end before the base."""
        self._over.set()
        for node in reversed(self._nodes):
            self._end_node(node)
        until = time.monotonic() + _NODE_LIMIT
        for node in self._nodes:
            node.over.wait(max(0.0, until - time.monotonic()))
            node.join()
        for thread in self._threads:  # each logs its exit code
            thread.join(max(0.0, until - time.monotonic()))


class _Release:
    """Releases a lock once, and makes a call; for two threads."""

    def __init__(self, lock: threading.Lock, then: Callable[[], None]) -> None:
        self._lock, self._then = lock, then
        self._once = threading.Lock()

    def __call__(self) -> None:
        if self._once.acquire(blocking=False):
            with suppress(RuntimeError):
                self._lock.release()
            self._then()


def main() -> NoReturn:
    """Run the plan that the command line names, and end without the clean-up of Python, which may take seconds."""
    code = Host(read_plan(sys.argv[1])).run()
    with suppress(OSError):  # it is no longer read
        sys.stdout.flush()
    os._exit(code)


if __name__ == "__main__":
    main()
