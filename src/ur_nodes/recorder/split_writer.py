"""MCAP files of a long recording: compressed, split, and ended before the disk is full."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, TYPE_CHECKING

from ur.recordings.mcap_channels import dialect_of, register_channel, start_writer
from ur_nodes.ports.raw import RecordedMessage, RecordedType

if TYPE_CHECKING:
    from mcap.writer import Writer

UNFINISHED = ".part"
"""Ending of the name of a file that is being written, or whose writer was killed."""


class NearlyFullError(Exception):
    """The recording ends; the text is for people."""


@dataclass(frozen=True, slots=True)
class SplitSettings:
    """`folder` gets the files; a new one begins after so many bytes or seconds. `free` bytes stay free on the disk.

    The disk is made to store what was written once in `sync` s.
    """

    folder: Path
    bytes: int = 500_000_000
    seconds: float = 600.0
    free: int = 500_000_000
    sync: float = 5.0


@dataclass(slots=True)
class _Open:
    path: Path
    file: IO[bytes]
    writer: Writer
    began: int
    channels: dict[RecordedType, int] = field(default_factory=dict)
    synced: float = 0.0


class SplitWriter:
    """Writes messages. `free` returns the free bytes of a folder's disk; a chunk has at most `chunk_bytes`."""

    def __init__(
        self,
        settings: SplitSettings,
        free: Callable[[Path], int] = lambda folder: shutil.disk_usage(folder).free,
        chunk_bytes: int = 128 * 1024,
    ) -> None:
        self._settings = settings
        self._free = free
        self._chunk_bytes = chunk_bytes
        self._stem = time.strftime("recording_%Y-%m-%d_%H-%M-%S")
        self._number = 0
        self._open: _Open | None = None
        self.finished: list[Path] = []

    def write(self, messages: Sequence[RecordedMessage], to_unix: int) -> None:
        """Write messages, whose times become ones since 1970 with `to_unix`; without any, only what is due is synced.

        Raises NearlyFullError, with all files complete: the recording is over. Raises OSError.
        """
        settings = self._settings
        settings.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if (free := self._free(settings.folder)) < settings.free:
            self.finish()
            raise NearlyFullError(
                f"{settings.folder}: {free // 1_000_000} MB are free, expected {settings.free // 1_000_000} MB"
            )
        for message in messages:
            stamp = max(0, message.time + to_unix)
            opened = self._current(message.type, stamp)
            if message.type not in opened.channels:
                kind = message.type
                opened.channels[kind] = register_channel(
                    opened.writer, kind.topic, kind.type_name, kind.schema, kind.sender, latched=kind.latched
                )
            opened.writer.add_message(opened.channels[message.type], stamp, message.data, stamp)
        if self._open is not None and time.monotonic() - self._open.synced > settings.sync:
            self._open.writer.flush()  # type: ignore[no-untyped-call]
            os.fsync(self._open.file.fileno())
            self._open.synced = time.monotonic()

    def _current(self, kind: RecordedType, stamp: int) -> _Open:
        opened = self._open
        if opened is not None:
            old = stamp - opened.began > self._settings.seconds * 1e9
            if old or opened.file.tell() > self._settings.bytes:
                self.finish()
        return self._open or self._begin(kind, stamp)

    def _begin(self, kind: RecordedType, stamp: int) -> _Open:
        self._number += 1
        path = self._settings.folder / f"{self._stem}_{self._number:03}.mcap"
        file = path.with_name(path.name + UNFINISHED).open("xb")
        os.fchmod(file.fileno(), 0o600)
        dialect = dialect_of(kind.type_name, kind.schema)
        writer = start_writer(file, dialect, metadata=False, chunk_bytes=self._chunk_bytes)
        self._open = _Open(path, file, writer, stamp)
        return self._open

    def finish(self) -> None:
        """Complete the file that is open. Raises OSError."""
        opened, self._open = self._open, None
        if opened is None:
            return
        with opened.file:
            opened.writer.finish()  # type: ignore[no-untyped-call]
            opened.file.flush()
            os.fsync(opened.file.fileno())
        opened.path.with_name(opened.path.name + UNFINISHED).replace(opened.path)
        self.finished.append(opened.path)
