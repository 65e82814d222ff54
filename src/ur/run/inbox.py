"""Requests of signal handlers and other threads, handled in the thread of the loop."""

from __future__ import annotations

import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress

Task = Callable[[], None]
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)  # signals that request the end of a run


class Inbox:
    """A queue of tasks, readable (`fileno`) while it is not empty. Handles SIGNALS until it is closed."""

    def __init__(self, take_signal: Callable[[int], None]) -> None:
        """Create the inbox; `take_signal` is called later, in the loop's thread, with a signal."""
        self._tasks: deque[Task] = deque()
        self._open = threading.Lock()  # held while the pipe is written to or closed
        self._closed = False
        self._reader, self._writer = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._old_writer = signal.set_wakeup_fd(self._writer, warn_on_full_buffer=False)
        self._handlers = {
            signum: signal.signal(signum, lambda number, _: self._tasks.append(lambda: take_signal(number)))
            for signum in SIGNALS
        }

    def fileno(self) -> int:
        """Return the descriptor for poll."""
        return self._reader

    def post(self, task: Task) -> None:
        """Queue a task for the loop. May be called from any thread. No effect after `close`."""
        with self._open:
            if self._closed:  # the descriptor may belong to another file by now
                return
            self._tasks.append(task)
            with suppress(BlockingIOError):  # the pipe is full: the loop wakes up anyway
                os.write(self._writer, b"\0")

    def clear(self) -> None:
        """Make the descriptor unreadable until the next task arrives."""
        try:
            while os.read(self._reader, 4096):
                pass
        except BlockingIOError:
            return

    def take(self) -> Iterator[Task]:
        """Iterate over the pending requests, oldest first, and remove each."""
        while self._tasks:
            yield self._tasks.popleft()

    def close(self) -> None:
        """Restore the previous signal handlers."""
        signal.set_wakeup_fd(self._old_writer)
        for signum, handler in self._handlers.items():
            signal.signal(signum, handler)
        with self._open:
            self._closed = True
            os.close(self._reader)
            os.close(self._writer)
