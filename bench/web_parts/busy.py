"""Time that processes wait for a processor, over time: what a busy computer adds to a measurement."""

import bisect
import threading
import time
from collections.abc import Callable, Iterable

_EVERY = 0.02  # s


class Waiting:
    """Samples the waiting time of processes, all their threads together, until `stop`."""

    def __init__(self, pids: Iterable[int], waited: Callable[[int], float]) -> None:
        """`waited` returns the total of a process in s."""
        self._pids, self._waited = tuple(pids), waited
        self._times: list[float] = []
        self._totals: list[float] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def between(self, begin: float, end: float) -> float:
        """Seconds waited between two times of time.monotonic()."""
        if not self._times:
            return 0.0
        first = max(0, bisect.bisect_right(self._times, begin) - 1)
        last = min(len(self._times) - 1, bisect.bisect_left(self._times, end))
        return self._totals[last] - self._totals[first]

    def stop(self) -> None:
        """End sampling."""
        self._ended.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._ended.wait(_EVERY):
            total = sum(self._waited(pid) for pid in self._pids)
            self._times.append(time.monotonic())
            self._totals.append(total)
