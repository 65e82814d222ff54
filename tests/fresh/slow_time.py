"""Let time pass more slowly for the Python programs of an emulated computer, whose processor is as much slower.

`begin` is called by a .pth file of the environment, before any other module has taken a clock for itself.
"""

import select
import selectors
import threading
import time
from collections.abc import Callable
from typing import Any


def begin(times: float, epoch: float) -> None:
    """Slow all clocks down; `epoch` is the time since 1970 (s) at which the slow clock and the real one agree."""

    def slow(clock: Callable[[], Any], since: float) -> Callable[[], Any]:
        whole = isinstance(clock(), int)
        start = int(since * 1e9) if whole else since
        return lambda: start + (clock() - start) // int(times) if whole else start + (clock() - start) / times

    def wait(call: Callable[..., Any], position: int) -> Callable[..., Any]:
        def longer(*arguments: Any, **named: Any) -> Any:
            values = list(arguments)
            if "timeout" in named and named["timeout"] is not None:
                named["timeout"] *= times
            elif len(values) > position and values[position] is not None:
                values[position] *= times
            return call(*values, **named)

        return longer

    for name, since in (("time", epoch), ("time_ns", epoch), ("monotonic", 0.0), ("monotonic_ns", 0.0)):
        setattr(time, name, slow(getattr(time, name), since))
    read = time.clock_gettime
    time.clock_gettime = lambda clock: read(clock) / times if clock == time.CLOCK_BOOTTIME else read(clock)
    time.sleep = wait(time.sleep, 0)
    select.select = wait(select.select, 3)
    threading._time = time.monotonic  # type: ignore[attr-defined] # taken already
    threading.Condition.wait = wait(threading.Condition.wait, 1)  # type: ignore[method-assign]
    for selector in (selectors.EpollSelector, selectors.PollSelector):
        selector.select = wait(selector.select, 1)  # type: ignore[method-assign]
