"""The one thread of a node: calls that arrive from anywhere, and those that repeat, one after the other."""

import contextlib
import heapq
import itertools
import math
import queue
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Protocol, TypeVar

Item = TypeVar("Item")
Value = TypeVar("Value")

_LONGEST_WAIT = 1.0  # s
_JOB_LIMIT = 2.0  # s
_ROUNDING = 1e-3  # s: a sum may be greater than its parts


class Beat:
    """A call that is made every `period` s, or once after it. See `ports.node.Timer`."""

    def __init__(self, period: float, call: Callable[[], None], *, once: bool = False) -> None:
        self.period = period
        self.call = call
        self.once = once
        self.on = True

    def cancel(self) -> None:
        self.on = False


class Beats:
    """Beats in the order in which they are due by `read` (s); `steady`: that is never set back."""

    def __init__(self, read: Callable[[], float], *, steady: bool = False) -> None:
        self._read, self._steady = read, steady
        self._beats: list[tuple[float, int, Beat]] = []
        self._numbers = itertools.count()

    def add(self, beat: Beat) -> Beat:
        """Have a beat called from its period on."""
        heapq.heappush(self._beats, (self._read() + beat.period, next(self._numbers), beat))
        return beat

    def due(self) -> float:
        """The time of the next beat; infinite: there is none."""
        return self._beats[0][0] if self._beats else math.inf

    def pop(self) -> Callable[[], None] | None:
        """The call of the beat that is due; None: there is none."""
        while self._beats and not self._beats[0][2].on:
            heapq.heappop(self._beats)
        if not self._beats:
            return None
        due, number, beat = self._beats[0]
        now = self._read()
        if not self._steady and any(then - now > each.period + _ROUNDING for then, _, each in self._beats):  # set back
            self._beats = [(now + each.period, count, each) for _, count, each in self._beats]
            heapq.heapify(self._beats)
            return None
        if due > now:
            return None
        if beat.once:
            heapq.heappop(self._beats)
        else:
            heapq.heapreplace(self._beats, (max(due + beat.period, now), number, beat))
        return beat.call


class Calls(Protocol):
    """A queue of calls, as `queue.SimpleQueue`; any thread may put some, the loop's alone gets them."""

    def put(self, call: Callable[[], None], /) -> None:
        """Append a call."""

    def get(self, *, timeout: float) -> Callable[[], None]:
        """Return the first call within so many seconds. Raises queue.Empty."""


class Loop:
    """Runs calls in the order in which they were posted, and beats when they are due by `read` (s).

    `steady`: `read` passes at the rate of real time, so that the wait for a beat can be slept. Otherwise `passed` is to
    be called when the time of `read` is another one.
    """

    def __init__(self, read: Callable[[], float], *, steady: bool, calls: Calls | None = None) -> None:
        self._calls: Calls = calls or queue.SimpleQueue()
        self._calls_first: Callable[[], bool] = getattr(calls, "comes_first", lambda: False)  # beats that are due wait
        self._read = read
        self._beats = Beats(read, steady=steady)
        self._steady_beats = self._beats if steady else Beats(time.monotonic, steady=True)
        self._all_beats = (self._beats,) if steady else (self._beats, self._steady_beats)
        self._awaited = math.inf  # the time by `read` of the beat that `passed` has to wake the thread for
        self._passed = -math.inf  # the newest time that `passed` has read
        self._thread: threading.Thread | None = None
        self._closing = False  # the last call is on its way
        self._ended = False

    def start(self, on_failure: Callable[[], None] = lambda: None) -> None:
        """Begin; what was posted before comes first. `on_failure` is called when an exception ends the thread."""
        self._on_failure = on_failure
        self._thread = threading.Thread(target=self._run, name="node", daemon=True)
        self._thread.start()

    def post(self, call: Callable[[], None]) -> None:
        """Have a call made. May come from any thread; after the end it does nothing."""
        self._calls.put(call)

    def passed(self) -> None:
        """Take note that the time is another one, later or set back. From the one thread that sets it."""
        now = self._read()
        if self._awaited <= now or now < self._passed:
            self._awaited = math.inf
            self.post(_look)
        self._passed = now

    def ask(self, call: Callable[[], None], within: float = 1.0) -> None:
        """As `post`, and wait until the call is made, at most `within` s. After the end it is made here."""
        if threading.current_thread() is self._thread:
            call()
            return
        done = threading.Event()

        def make() -> None:
            call()
            done.set()

        if self._thread is not None and (self._closing or not self._thread.is_alive()):
            self._thread.join(within)
            call()
        else:
            self.post(make)
            done.wait(within)

    def mailbox(self, depth: int | None, callback: Callable[[Item], None]) -> Callable[[Item], None]:
        """A function, for any thread, that posts what it gets to `callback`; of more than `depth` the oldest goes."""
        waiting: deque[Item] = deque(maxlen=depth)
        lock = threading.Lock()  # as many calls wait as items, so that a flood delays no other call for long

        def deliver() -> None:
            with lock:
                item = waiting.popleft()
            callback(item)

        def put(item: Item) -> None:
            with lock:
                replaces = len(waiting) == depth
                waiting.append(item)
            if not replaces:
                self._calls.put(deliver)

        return put

    def every(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> Beat:
        """Repeat a call; `steady`: in real time. Only from the loop's own thread, or before it starts."""
        return (self._steady_beats if steady else self._beats).add(Beat(seconds, call))

    def after(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> Beat:
        """As `every`, once."""
        return (self._steady_beats if steady else self._beats).add(Beat(seconds, call, once=True))

    def end(self, last: Callable[[], None], within: float) -> None:
        """Make a last call on the loop's thread, drop what waits, and wait until it is done, at most `within` s.

        Where an exception has ended the thread, the call is made here.
        """

        def finish() -> None:
            self._ended = True
            last()

        if self._thread is None or self._thread.ident in (None, threading.get_ident()):  # None: it has not begun
            finish()
            return
        self._closing = True
        self._calls.put(finish)
        self._thread.join(within)
        if not self._thread.is_alive() and not self._ended:
            finish()

    def _run(self) -> None:
        try:
            while not self._ended:
                for beats in self._all_beats:
                    if not self._calls_first() and (beat := beats.pop()) is not None:
                        beat()
                try:
                    call = self._calls.get(timeout=max(0.0, self._wait()))
                except queue.Empty:
                    continue
                call()
        except BaseException:
            try:
                threading.excepthook(threading.ExceptHookArgs((*sys.exc_info(), threading.current_thread())))
            finally:
                self._on_failure()  # after it is known why, also where the reason cannot be written

    def _wait(self) -> float:
        """The longest time (s) to wait for a call."""
        if self._beats is not self._steady_beats:
            self._awaited = self._beats.due()  # before time is read: else `passed` could come between the two
            if self._awaited <= self._read():
                return 0.0
        return min(self._steady_beats.due() - time.monotonic(), _LONGEST_WAIT)


def _look() -> None:
    """Do nothing: beats are looked at after each call."""


class Worker:
    """Jobs beside the loop, one after the other, on a thread that begins with the first."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._jobs: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()  # None: the end
        self._thread: threading.Thread | None = None

    def add(self, job: Callable[[], None]) -> None:
        """Have a job done."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name=self._name, daemon=True)
            self._thread.start()
        self._jobs.put(job)

    def drop(self) -> None:
        """Forget the jobs that wait."""
        with contextlib.suppress(queue.Empty):
            while True:
                self._jobs.get_nowait()

    def end(self) -> None:
        """Forget the jobs that wait, and end the thread after the one that runs."""
        self.drop()
        self._jobs.put(None)

    def join(self, within: float) -> None:
        """Wait for the end, at most `within` s."""
        if self._thread is not None:
            self._thread.join(within)

    def _run(self) -> None:
        while (job := self._jobs.get()) is not None:
            job()


class SerialQueues:
    """Jobs beside the loop, those of one lane one after the other."""

    def __init__(self) -> None:
        self._workers: dict[str, Worker] = {}

    def add(
        self,
        job: Callable[[], Value],
        callback: Callable[[Value], None],
        queue: str,
        post: Callable[[Callable[[], None]], object],
    ) -> None:
        """Have a job done, then have its result taken by `post`, which calls where the node runs."""

        def carry_out() -> None:
            try:
                result = job()
            except Exception as problem:  # the node fails where it runs: the jobs of its end can still be done
                post(partial(_fail, problem))
            else:
                post(lambda: callback(result))

        self._workers.setdefault(queue, Worker(f"work {queue}".strip())).add(carry_out)

    def drop(self) -> None:
        """Forget the jobs that wait."""
        for worker in self._workers.values():
            worker.drop()

    def end(self) -> None:
        """Forget the jobs that wait, and end each lane after the one that runs."""
        for worker in self._workers.values():
            worker.end()

    def join(self) -> None:
        """Wait for jobs that still run, for a while: Python aborts where it ends while a thread is in a library."""
        until = time.monotonic() + _JOB_LIMIT
        for worker in self._workers.values():
            worker.join(max(0.0, until - time.monotonic()))


def steady_time() -> float:
    """The time (s) of `Node.steady`: it passes while the computer sleeps, too, and is never set."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)


def _fail(problem: Exception) -> None:
    raise problem


def run_aside(call: Callable[[], None]) -> None:
    """Make a call on a thread of its own."""
    threading.Thread(target=call, name="call", daemon=True).start()
