"""Limits on the log files of a run: the oldest part of a file above its limit is removed."""

import ctypes
import fcntl
import os
import stat
from collections.abc import Callable, Mapping

from ur.source.data_classes import dataclass
from ur.source.diagnostic import user_error

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


BOUND_VARIABLE = "UR_LOG_MB"
_DEFAULT_MB = 32
_LARGEST_MB = 1_000_000
_FILES = 16  # full files that a run may have before the limit of each is reduced
_SHORTEST, _LONGEST = 0.5, 5.0  # s between two checks
_ROSOUT = "rosout.log"  # its node does not append, and starts another file after 100 MB


@dataclass(frozen=True, slots=True)
class LogBounds:
    """The maximum size of one log file, and of all log files of a run together, in bytes."""

    file: int = _DEFAULT_MB * 1_000_000
    run: int = _FILES * _DEFAULT_MB * 1_000_000


def read_bounds(environment: Mapping[str, str]) -> LogBounds:
    """Read the limits from the variable UR_LOG_MB, MB of one file; a run may have 16 times as much.

    Raises UserError.
    """
    text = environment.get(BOUND_VARIABLE, "").strip()
    if not text:
        return LogBounds()
    try:
        bound = float(text)
    except ValueError:
        bound = 0.0
    if not 0.1 <= bound <= _LARGEST_MB:
        raise user_error(
            f"{BOUND_VARIABLE} is '{text}', expected the largest size of a log file in MB, at least 0.1",
            rule="bad-log-bound",
            help=f"unset {BOUND_VARIABLE}, which means {_DEFAULT_MB}",
            subject=BOUND_VARIABLE,
        )
    return LogBounds(round(bound * 1e6), round(bound * 1e6) * _FILES)


def plan_cuts(sizes: Mapping[str, int], bounds: LogBounds) -> dict[str, int]:
    """Return the bytes to keep of each file that is too large: half of its limit.

    Its limit is that of one file, or less if all files together would exceed the limit of the run; files below their
    share leave the rest of it to the others.
    """
    level, left = bounds.file, bounds.run
    for rank, size in enumerate(sorted(sizes.values())):
        share = left // (len(sizes) - rank)
        if size > share:
            level = min(level, share)
            break
        left -= size
    return {path: level // 2 for path, size in sizes.items() if size > level}


def plan_delay(before: int, now: int, elapsed: float, room: int) -> float:
    """Return the time (s) until the next check: half of the time in which growing files will fill the room (bytes)."""
    growth = (now - before) / elapsed if elapsed > 0 else 0.0
    return _LONGEST if growth <= 0 else min(_LONGEST, max(_SHORTEST, room / growth / 2))


class LogRotation:
    """The log files of one run in its folder, which may hold those of other runs, too."""

    def __init__(
        self, folder: str, bounds: LogBounds, drop: Callable[[str, int], int] | None = None, now: float = 0.0
    ) -> None:
        """`drop(path, keep)` removes the beginning of a file and returns the number of removed bytes."""
        self._folder = folder
        self._bounds = bounds
        self._drop = drop or drop_beginning
        self._names: set[str] = set()
        self._checked = now
        self._total = 0
        self.due = now + _SHORTEST

    def add(self, log_name: str) -> None:
        """Include the files of a program: its output, and the log that rospy writes."""
        self._names |= {f"{log_name}-stdout.log", f"{log_name}.log"}
        if log_name.startswith("rosout-"):
            self._names.add(_ROSOUT)

    def check(self, now: float) -> dict[str, int]:
        """Cut files that are too large; return the number of bytes removed from the beginning of each path."""
        sizes, fixed = self._measure()
        total = sum(sizes.values()) + fixed
        bounds = LogBounds(self._bounds.file, max(0, self._bounds.run - fixed))
        removed = {path: self._drop(path, keep) for path, keep in plan_cuts(sizes, bounds).items()}
        left = total - sum(removed.values())
        room = min(self._bounds.run - left, self._bounds.file - max(sizes.values(), default=0))
        self.due = now + plan_delay(self._total, total, now - self._checked, max(0, room))
        self._checked, self._total = now, left
        return {path: count for path, count in removed.items() if count}

    def _measure(self) -> tuple[dict[str, int], int]:
        """Return the size of each own file that may be cut, and of all others together; delete old rosout files."""
        sizes, fixed = {}, 0
        try:
            with os.scandir(self._folder) as entries:
                for entry in entries:
                    stem, _, number = entry.name.rpartition(".")
                    if entry.name in self._names and entry.name != _ROSOUT:
                        sizes[entry.path] = entry.stat(follow_symlinks=False).st_size
                    elif entry.name in self._names or (stem in self._names and number == "1"):
                        fixed += entry.stat(follow_symlinks=False).st_size
                    elif stem in self._names and number.isdigit():
                        os.unlink(entry.path)  # noqa: PTH108 - pathlib is not worth its import here
        except OSError:
            return sizes, fixed  # the folder, or a file, was removed meanwhile
        return sizes, fixed
