"""The part of a node that a serial line needs, in real time, without a loop."""

import sys
import threading
from collections.abc import Callable
from typing import Any

from ur_nodes.ports.log import ThrottledLog


class ThreadedNode:
    """Each job, and what takes its result, has a thread. A line has one job at a time."""

    def __init__(self) -> None:
        write = sys.stderr.write
        self.log = ThrottledLog(write, write, write, write, lambda: 0.0)

    def work(self, job: Callable[[], Any], callback: Callable[[Any], None], queue: str = "") -> None:
        threading.Thread(target=lambda: callback(job()), name=queue, daemon=True).start()

    def after(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> None:
        assert steady
        timer = threading.Timer(seconds, call)
        timer.daemon = True
        timer.start()

    def now(self) -> int:
        return 7
