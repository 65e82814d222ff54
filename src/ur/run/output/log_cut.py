"""Removal of the beginning of a file to which processes append."""

from __future__ import annotations

import ctypes
import fcntl
import os
import stat
from collections.abc import Callable

MARK = b"... older lines were removed here"
_COLLAPSE_RANGE = 8  # fallocate(2): FALLOC_FL_COLLAPSE_RANGE
_BLOCK = 4096  # the removed length is a multiple of it, independent of the file system's own block size
_CHUNK = 1 << 20  # bytes copied at once
_FIRST_LINES = 64 * 1024  # bytes in which a line break is searched for


def drop_beginning(path: str, keep: int, collapse: Callable[[int, int], bool] | None = None) -> int:
    """Remove the beginning of a file up to about its last `keep` bytes; returns the number of removed bytes, or 0.

    The file keeps its inode, so that processes which opened it with O_APPEND go on writing to it. ext4 and XFS remove
    blocks; elsewhere the end is copied to the beginning, and lines written between the last copy and the following
    truncation are lost. The remainder of the first line is replaced by MARK. 0: the file is small enough, is no regular
    file, belongs to another user, or is being cut by another process. `collapse` removes blocks, or returns False.
    """
    try:
        file = os.open(path, os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK)
    except OSError:
        return 0
    try:
        status = os.fstat(file)
        block = max(_BLOCK, status.st_blksize)
        removed = (status.st_size - keep) // block * block
        if not stat.S_ISREG(status.st_mode) or removed <= 0:
            return 0
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if not (collapse or _collapse)(file, removed):
            _shift(file, removed)
        _mark(file)
    except OSError:
        return 0
    else:
        return removed
    finally:
        os.close(file)


def _collapse(file: int, length: int) -> bool:
    """Have the file system remove the first `length` bytes; False if it cannot."""
    try:
        fallocate = ctypes.CDLL(None).fallocate64
    except (OSError, AttributeError):  # a C library without this function
        return False
    fallocate.argtypes = (ctypes.c_int, ctypes.c_int, ctypes.c_int64, ctypes.c_int64)
    return bool(fallocate(file, _COLLAPSE_RANGE, 0, length) == 0)


def _shift(file: int, length: int) -> None:
    """Copy the bytes after the first `length` bytes over them, and truncate the file."""
    place = 0
    while data := os.pread(file, _CHUNK, length + place):
        while data:
            written = os.pwrite(file, data, place)
            place, data = place + written, data[written:]
    os.ftruncate(file, place)


def _mark(file: int) -> None:
    """Overwrite the file's first line, which is incomplete, and as many more as MARK needs."""
    end = os.pread(file, _FIRST_LINES, 0).find(b"\n", len(MARK))
    if end > 0:
        os.pwrite(file, MARK.ljust(end), 0)
