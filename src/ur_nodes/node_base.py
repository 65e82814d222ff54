"""The part of a node that is the same on every middleware with threads: its loop, its jobs and its end."""

import queue
import time
from collections.abc import Callable, Mapping
from typing import TypeVar

from ur_nodes.loop import Beat, Loop, SerialQueues, steady_time
from ur_nodes.ports.log import Log
from ur_nodes.ports.parameters import Parameters

Value = TypeVar("Value")

_CHANGE_LIMIT = 5.0  # s
_END_LIMIT = 3.0  # s, besides the time that the jobs of the end have


class LoopNode:
    """See `ports.node.Node` for the methods. `failed`: a call of the end has failed."""

    steady = staticmethod(steady_time)

    def __init__(self, loop: Loop, log: Log, parameters: Parameters) -> None:
        self.log = log
        self.parameters = parameters
        self.failed = False
        self._loop = loop
        self._lanes = SerialQueues()
        self._at_end: list[Callable[[], None]] = []
        self._ending = False
        self._end_limit = 0.0  # s for the jobs of the end
        self._unfinished = 0  # of these
        self._results: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()  # of these

    def every(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> Beat:
        return self._loop.every(seconds, call, steady=steady)

    def after(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> Beat:
        return self._loop.after(seconds, call, steady=steady)

    def post(self, call: Callable[[], None]) -> None:
        self._loop.post(call)

    def work(self, job: Callable[[], Value], callback: Callable[[Value], None], queue: str = "") -> None:
        self._unfinished += self._ending
        post = self._results.put if self._ending else self._loop.post
        self._lanes.add(job, callback, queue, post)

    def hold_messages(self, hold: bool) -> None:
        """See Node: here messages do not wait."""

    def on_end(self, call: Callable[[], None], within: float = 2.0) -> None:
        self._at_end.append(call)
        self._end_limit = max(self._end_limit, within)

    def change(self, values: Mapping[str, object]) -> str:
        """Change parameters of the node on its thread, for another one. Return '' or the reason of a refusal."""
        answers: list[str] = []

        def apply() -> None:
            if not answers:
                answers.append(self.parameters.change(values))

        self._loop.ask(apply, _CHANGE_LIMIT)
        if not answers:
            answers.append(f"the node has not answered within {_CHANGE_LIMIT:g} s")
        return answers[0]

    def finish(self, shutdown: Callable[[], None]) -> None:
        """Make the calls of the end on the node's thread; after them `shutdown`, which sends what waits."""
        self._loop.end(lambda: self._finish(shutdown), _END_LIMIT + self._end_limit)
        self._lanes.end()
        self._lanes.join()

    def _finish(self, shutdown: Callable[[], None]) -> None:
        self._lanes.drop()
        self._ending = True
        for call in self._at_end:
            self._attempt(call)
        end = time.monotonic() + self._end_limit
        while self._unfinished:
            try:
                take = self._results.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                break
            self._unfinished -= 1
            self._attempt(take)
        if self._at_end:
            shutdown()

    def _attempt(self, call: Callable[[], None]) -> None:
        """Make a call of the end; where it fails, the others are made all the same."""
        try:
            call()
        except Exception as problem:
            self.failed = True
            self.log.error(repr(problem))
