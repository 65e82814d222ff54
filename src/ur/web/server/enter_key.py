"""The Enter key of the terminal that runs a server."""

import asyncio
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

_PAUSE = 0.5  # s between checks of a terminal that belongs to another program


@contextmanager
def call_on_enter(act: Callable[[], object]) -> Iterator[bool]:
    """Call `act` for each press of Enter while the context lasts; yield whether a terminal is available.

    In the background the terminal belongs to the shell: nothing is read then, which would stop this process.
    """
    if not sys.stdin or sys.stdin.closed or not sys.stdin.isatty():
        yield False
        return
    loop, descriptor = asyncio.get_running_loop(), sys.stdin.fileno()
    waiting: list[asyncio.TimerHandle] = []

    def read() -> None:
        if _is_in_background(descriptor):
            loop.remove_reader(descriptor)
            waiting[:] = [loop.call_later(_PAUSE, loop.add_reader, descriptor, read)]
            return
        data = b""
        with suppress(OSError):
            data = os.read(descriptor, 1024)
        if data:
            act()
        else:  # the terminal has closed
            loop.remove_reader(descriptor)

    loop.add_reader(descriptor, read)
    try:
        yield True
    finally:
        loop.remove_reader(descriptor)
        for each in waiting:
            each.cancel()


def _is_in_background(descriptor: int) -> bool:
    try:
        return os.tcgetpgrp(descriptor) != os.getpgrp()
    except OSError:  # not the controlling terminal of this process
        return False
