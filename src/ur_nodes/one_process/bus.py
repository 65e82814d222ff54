"""A bus in real time: its events happen on one thread, jobs of nodes on workers."""

from __future__ import annotations

import math
import queue
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, ClassVar, TypeVar, cast

from ur_nodes.loop import SerialQueues
from ur_nodes.memory.bus import REPLACED, Bus
from ur_nodes.memory.carrier import Carrier
from ur_nodes.memory.node import MemoryNode
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.log import ThrottledLog

if TYPE_CHECKING:
    from ur_nodes.ports.node import Facts

Value = TypeVar("Value")
WriteLine = Callable[[str, str, str], None]
"""Takes a level, the name of a node, and a line of its log."""

_LONGEST_WAIT = 1.0  # s
_PATIENCE = 100_000_000  # ns of which events may make up for
_END_LIMIT = 2.0  # s for the callback that runs


class LiveNode(MemoryNode):
    """See MemoryNode. `over` is set, and `at_over` called, when it has ended; `replaced`: another took its name."""

    def __init__(self, bus: Carrier, name: str, remaps: dict[str, str]) -> None:
        super().__init__(bus, name, remaps)
        live = cast("LiveBus", bus)
        self.facts = live.run_facts
        self.log = live.make_log(self.name)
        self.over = threading.Event()
        self.at_over: Callable[[], None] = lambda: None
        self.replaced = False
        self._lanes = SerialQueues()

    def work(self, job: Callable[[], Value], callback: Callable[[Value], None], queue: str = "") -> None:
        """See Node. Jobs that start at the end of the node run at once."""
        if self._late is not None:
            super().work(job, callback, queue)
        else:
            self._lanes.add(job, callback, queue, self.post)

    def read_graph(self, callback: Callable[[Graph | None], None]) -> None:
        self.post(lambda: callback(self._bus.graph()))

    def end(self, reason: str, *, failed: bool = False) -> None:
        if self._late is not None:
            return
        super().end(reason, failed=failed)
        self.replaced = reason == REPLACED
        self._lanes.end()
        self.over.set()
        self.at_over()

    def join(self) -> None:
        """Wait a limited time for running jobs."""
        self._lanes.join()


class LiveBus(Bus):
    """See Bus. `facts` are those of the run; `write_line` takes the lines of the nodes' logs.

    Time waits for events that are due, and while `held`: on a slow computer all that is simulated takes longer.
    `real` is a steady time (ns). `failed` is true when a callback has failed: then nothing happens any more, and every
    node is over. `fail` takes the exception.
    """

    node_class: ClassVar[type[MemoryNode]] = LiveNode

    def __init__(
        self,
        facts: Facts,
        write_line: WriteLine,
        fail: Callable[[threading.ExceptHookArgs], None] | None = None,
        real: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        super().__init__()
        self._fail = fail
        self.run_facts, self.write_line = facts, write_line
        self.failed = self.held = False
        self._real = real
        # What is added to the real time, and the latest time that is given
        self._clock: tuple[int, float] = time.time_ns() - real(), time.time_ns()
        self._woken = threading.Event()
        self._closed = False
        self._thread = threading.Thread(target=self._spin, name="bus", daemon=True)

    def make_log(self, node: str) -> ThrottledLog:
        """Return the log of a node, without debug lines."""
        info, warn, error = (partial(self.write_line, level, node) for level in ("INFO", "WARN", "ERROR"))
        return ThrottledLog(lambda _text: None, info, warn, error, time.monotonic)

    @property
    def now(self) -> int:
        """Return the time, ns since the epoch."""
        offset, latest = self._clock
        return int(min(self._real() + offset, latest))

    def begin(self) -> None:
        """Start to run events."""
        self._thread.start()

    def at(self, time: int, call: Callable[[], None]) -> None:
        super().at(time, call)
        if threading.current_thread() is not self._thread:
            self._woken.set()

    def do(self, call: Callable[[], Value]) -> Value:
        """Call on the thread of the bus, and return the result. Raises its exceptions.

        RuntimeError: the bus has failed or is closed.
        """
        if threading.current_thread() is self._thread:
            return call()
        results: queue.SimpleQueue[tuple[Value | None, BaseException | None]] = queue.SimpleQueue()

        def make() -> None:
            try:
                results.put((call(), None))
            except BaseException as problem:  # it belongs to the caller
                results.put((None, problem))

        self.at(self.now, make)
        while True:
            try:
                value, problem = results.get(timeout=_LONGEST_WAIT)
            except queue.Empty:
                if self._thread.is_alive() or not self._thread.ident:
                    continue
                raise RuntimeError("the nodes have ended") from None
            if problem is not None:
                raise problem
            return cast("Value", value)

    def close(self) -> None:
        """Stop running events."""
        self._closed = True
        self._woken.set()
        if self._thread.ident and threading.current_thread() is not self._thread:
            self._thread.join(_END_LIMIT)

    def _let_pass(self) -> None:
        """Let time pass until the next event, and leave out by how much the computer is too slow for it."""
        real, (offset, latest) = self._real(), self._clock
        now = int(min(real + offset, latest))
        due = max(now, self._events[0][0]) if self._events else math.inf
        self._clock = int(min(offset, due + _PATIENCE - real)), now if self.held else due

    def _spin(self) -> None:
        try:
            while not self._closed:
                self._let_pass()
                wait = (self._next_time() - self.now) * 1e-9
                if wait > 0.0:
                    self._woken.wait(min(wait, _LONGEST_WAIT))
                    self._woken.clear()
                    continue
                for _ in range(len(self._due) or 1):  # all of them before more time passes
                    self._run_next()
        except BaseException:
            self.failed = True
            fail = self._fail or threading.excepthook  # of now: a user interface has one of its own
            fail(threading.ExceptHookArgs((*sys.exc_info(), threading.current_thread())))
            for node in cast("list[LiveNode]", list(self.nodes.values())):
                node.failed = True
                node.over.set()
                node.at_over()
