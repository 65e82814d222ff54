"""The newest frame of each key: what a page gets when it comes, and what a slow page is still owed."""

from __future__ import annotations

from collections.abc import Iterator

from ur.web.wire.frames import Key, Kind, generation_of, key_of


class Frames:
    """Frames by key. A grid of another generation drops the tiles of its layer."""

    def __init__(self) -> None:
        self._frames: dict[Key, bytes] = {}

    def __len__(self) -> int:
        return len(self._frames)

    def __iter__(self) -> Iterator[bytes]:
        return iter(list(self._frames.values()))

    def put(self, frame: bytes) -> None:
        """Take a frame, in place of the one with the same key. Raises ValueError: it is none."""
        key = key_of(frame)
        if key[0] == Kind.GRID:
            generation = generation_of(frame)
            void = [
                each
                for each, tile in self._frames.items()
                if each[0] == Kind.TILE and each[1] == key[1] and generation_of(tile) != generation
            ]
            for each in void:
                del self._frames[each]
        self._frames[key] = frame

    def take(self) -> bytes | None:
        """Remove and return the most urgent frame: the lowest kind, the oldest key first; None when there is none."""
        if not self._frames:
            return None
        key = min(self._frames, key=lambda each: each[0])
        return self._frames.pop(key)

    def clear(self) -> None:
        """Forget all frames."""
        self._frames.clear()
