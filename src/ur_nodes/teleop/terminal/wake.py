"""A pipe by which one thread wakes another that waits in `select`."""

from __future__ import annotations

import contextlib
import os
import select


class Wake:
    """A pipe: `ring` makes `descriptor` readable until `clear`."""

    def __init__(self) -> None:
        self.descriptor, self._bell = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)

    def ring(self) -> None:
        """Wake the thread that waits. Never blocks."""
        with contextlib.suppress(OSError):  # full: the thread is awake already
            os.write(self._bell, b"\0")

    def clear(self) -> bool:
        """Empty the pipe and return whether `ring` was called since the last time."""
        try:
            return bool(os.read(self.descriptor, 4096))
        except OSError:
            return False

    def wait(self, seconds: float) -> bool:
        """Wait for a ring, at most so long; return whether there was one."""
        return bool(select.select([self.descriptor], [], [], max(0.0, seconds))[0]) and self.clear()
