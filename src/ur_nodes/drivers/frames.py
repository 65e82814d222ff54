"""Frames in a stream of bytes, found again after noise, in bounded memory. Pure."""

from collections.abc import Callable

MORE = 0
"""Returned by `measure` while the length cannot be known yet."""
NONE = -1
"""Returned by `measure` for bytes that begin no frame."""


class FrameReader:
    """Cuts frames that begin with `start` out of what a device sends.

    `measure` gets the bytes from a start on and returns the length of the frame, MORE or NONE; `is_valid` gets the
    whole frame. After bytes that are no valid frame the search goes on with the next start, so a damaged frame costs
    itself and no other. `rejected` counts the starts that were followed by no valid frame. No more than `longest` bytes
    are kept.
    """

    def __init__(
        self, start: bytes, measure: Callable[[bytes], int], is_valid: Callable[[bytes], bool], longest: int
    ) -> None:
        self._start, self._measure, self._is_valid, self._longest = start, measure, is_valid, longest
        self._buffer = b""
        self.rejected = 0

    def receive(self, data: bytes) -> list[bytes]:
        """Take bytes as they arrive, and return the frames that they complete."""
        buffer, at, frames = self._buffer + data, 0, []
        while (at := self._find(buffer, at)) < len(buffer):
            rest = buffer[at : at + self._longest]
            size = self._measure(rest)
            if size > self._longest or (size == MORE and len(rest) == self._longest):
                size = NONE
            if size == MORE or size > len(rest):
                break
            if size > 0 and self._is_valid(rest[:size]):
                frames.append(rest[:size])
                at += size
            else:
                self.rejected += 1
                at += 1
        self._buffer = buffer[at:]
        return frames

    def clear(self) -> None:
        """Forget what was begun, as after another device was plugged in."""
        self._buffer = b""

    def _find(self, buffer: bytes, at: int) -> int:
        """Find the next start, or the beginning of one at the end; the length of the buffer where there is none."""
        found = buffer.find(self._start, at)
        if found >= 0:
            return found
        for size in range(min(len(self._start) - 1, len(buffer) - at), 0, -1):
            if buffer.endswith(self._start[:size]):
                return len(buffer) - size
        return len(buffer)


def fixed(size: int) -> Callable[[bytes], int]:
    """A `measure` for frames that are all of one length."""
    return lambda _: size
