"""Reader of a growing log file, also while its beginning is removed."""

from __future__ import annotations

import os

_REMEMBERED = 1024  # bytes before the position, by which it is found again


class LogFollower:
    """The bytes of an open log file, from its beginning on."""

    def __init__(self, file: int) -> None:
        self._file = file
        self._position = 0
        self._last = b""

    def read(self) -> bytes:
        """Return the bytes since the last call.

        If the beginning of the file was removed, these are the bytes after those returned last; the whole file if those
        were removed, too. Raises OSError.
        """
        size = os.fstat(self._file).st_size
        if size == self._position:
            return b""
        if size < self._position or not self._is_known(self._position):
            self._position = self._find(size)
        parts = []
        while part := os.pread(self._file, 1 << 20, self._position):
            parts.append(part)
            self._position += len(part)
        data = b"".join(parts)
        self._last = (self._last + data[-_REMEMBERED:])[-_REMEMBERED:]
        return data

    def _is_known(self, position: int) -> bool:
        return os.pread(self._file, len(self._last), position - len(self._last)) == self._last

    def _find(self, size: int) -> int:
        """Return the latest position in a file of this size after the bytes read last; 0 if there is none."""
        wanted = self._last
        end = size
        while wanted and end > 0:
            start = max(0, end - (1 << 20))
            found = os.pread(self._file, end - start, start).rfind(wanted)
            if found >= 0:
                return start + found + len(wanted)
            end = start + len(wanted) - 1 if start else 0
        return 0
