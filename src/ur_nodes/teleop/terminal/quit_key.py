"""The key that ends a program which prints lines."""

import os
import select
import threading


class QuitKey:
    """Reads a file descriptor for a `q`. Its end, as that of an empty pipe, does not end the program."""

    def __init__(self, source: int) -> None:
        self._source: int | None = source

    def wait(self, seconds: float, ended: threading.Event) -> bool:
        """Wait for `q` or for `ended`, at most `seconds`; return whether `q` was read."""
        if self._source is None:
            ended.wait(seconds)
        elif select.select([self._source], [], [], seconds)[0]:
            data = os.read(self._source, 1024)
            if b"q" in data:
                return True
            if not data:
                self._source = None
        return False
