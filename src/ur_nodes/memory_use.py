"""Return of memory to the system, for nodes that hold maps, and for programs that have compiled what they run."""

import ctypes
from contextlib import suppress
from pathlib import Path

LARGE = 8_000_000  # bytes: arrays of a whole large map, but nothing that is made many times a second
_SPARE = 4_000_000  # bytes that each thread keeps of smaller ones
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # malloc.h
_DONTNEED = 4  # mman.h


def return_large_arrays() -> None:
    """Have glibc give arrays from LARGE bytes up back to the system as soon as they are freed.

    By itself it keeps up to 64 MB of such memory for each thread once one was freed. Does nothing with another libc.
    """
    with suppress(OSError, AttributeError):
        libc = ctypes.CDLL(None)
        libc.mallopt(_MMAP_THRESHOLD, LARGE)
        libc.mallopt(_TRIM_THRESHOLD, _SPARE)


def return_code(library: str) -> None:
    """Give freed memory back to the system, and the code of a library that has done its work: it is read again if run.

    Does nothing without glibc's functions.
    """
    with suppress(OSError, AttributeError):
        libc = ctypes.CDLL(None)
        libc.malloc_trim(0)
        for line in Path("/proc/self/maps").read_text().splitlines():
            span, rights = line.split()[:2]
            if library in line and rights == "r-xp":  # what may be written holds relocated addresses
                start, end = (int(each, 16) for each in span.split("-"))
                libc.madvise(ctypes.c_void_p(start), ctypes.c_size_t(end - start), _DONTNEED)
