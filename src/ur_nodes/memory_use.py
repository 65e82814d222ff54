"""Return of freed memory to the system, for nodes that hold maps."""

import ctypes
from contextlib import suppress

LARGE = 8_000_000  # bytes: arrays of a whole large map, but nothing that is made many times a second
_SPARE = 4_000_000  # bytes that each thread keeps of smaller ones
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # malloc.h


def return_large_arrays() -> None:
    """Have glibc give arrays from LARGE bytes up back to the system as soon as they are freed.

    By itself it keeps up to 64 MB of such memory for each thread once one was freed. Does nothing with another libc.
    """
    with suppress(OSError, AttributeError):
        libc = ctypes.CDLL(None)
        libc.mallopt(_MMAP_THRESHOLD, LARGE)
        libc.mallopt(_TRIM_THRESHOLD, _SPARE)
