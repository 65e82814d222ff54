"""Pipes to guards that read nothing, for tests that see what a guard would read."""

import contextlib
import os

_PART = 4096


def open_pipe() -> tuple[int, int]:
    """The ends to read and to write, of which neither waits."""
    theirs, ours = os.pipe()
    os.set_blocking(theirs, False)
    os.set_blocking(ours, False)
    return theirs, ours


def fill_pipe(number: int) -> int:
    """Write zeros until no byte fits; return their number."""
    size = 0
    with contextlib.suppress(BlockingIOError):
        while True:
            size += os.write(number, bytes(_PART))
    return size


def read_rest(number: int) -> bytes:
    """Read a pipe to its end. Raises BlockingIOError: its other end is open."""
    data = b""
    while part := os.read(number, _PART):
        data += part
    return data
