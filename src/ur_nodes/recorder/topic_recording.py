"""Recording of topics to MCAP files: compressed, split, and ended before the disk is full."""

from __future__ import annotations

import os
import shutil
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import IO, TYPE_CHECKING

from ur.recordings.black_boxes import long_recordings_folder
from ur.recordings.mcap_channels import dialect_of, register_channel, start_writer
from ur_nodes.black_box.black_box import MOST_TOPICS, select_topics
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.raw import RecordedMessage, RecordedTopic, RecordedType

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


_LOOK = 1.0  # s between two looks at the graph
_WRITE = 0.5  # s between two writes
_MOST_WAITING = 64_000_000  # bytes of messages that are not written yet
_MOST_LARGE_WAITING = 32_000_000  # likewise, above which large ones are left out, so that the others stay complete
_LARGE = 200_000  # bytes of a message
_LANE = "recording"


class RecordNode:
    """Records topics whose names fit one of the patterns; without patterns all of them.

    `steady_ns` and `unix_ns` read a clock that is never set, and the computer's.
    """

    def __init__(
        self, node: Node, steady_ns: Callable[[], int] = time.monotonic_ns, unix_ns: Callable[[], int] = time.time_ns
    ) -> None:
        self._node = node
        self._patterns = tuple(f"/{each.lstrip('/')}" for each in node.parameters.text("topics", "").split())
        self._pictures = node.parameters.boolean("pictures", True)
        self._writer = SplitWriter(read_settings(node.parameters))
        self._to_unix = unix_ns() - steady_ns()
        self._waiting: list[RecordedMessage] = []
        self._bytes = 0
        self._left_out: dict[str, int] = {}
        self._busy = self._over = False
        self._announced = 0
        self._recorder = node.raw.record(self._on_batch, steady_ns)
        node.on_end(self._recorder.close)
        node.on_end(self._end, within=10.0)
        node.read_graph(self._choose)
        node.every(_WRITE, self._write, steady=True)

    def _choose(self, graph: Graph | None) -> None:
        self._node.after(_LOOK, lambda: self._node.read_graph(self._choose), steady=True)
        if graph is not None and not self._over:
            self._recorder.record(choose_topics(graph.without(self._node.name), self._patterns, self._pictures))

    def _on_batch(self, batch: Sequence[RecordedMessage]) -> None:
        if self._over:
            return
        for message in batch:
            large = len(message.data) > _LARGE
            if self._bytes > (_MOST_LARGE_WAITING if large else _MOST_WAITING):  # the disk is slower than the topics
                self._left_out[message.type.topic] = self._left_out.get(message.type.topic, 0) + 1
                continue
            self._waiting.append(message)
            self._bytes += len(message.data)

    def _write(self) -> None:
        if self._busy or self._over:
            return
        self._busy = True
        messages, self._waiting, self._bytes = self._waiting, [], 0
        self._node.work(lambda: self._store(messages), self._report, _LANE)

    def _store(self, messages: Sequence[RecordedMessage]) -> str:
        try:
            self._writer.write(messages, self._to_unix)
        except NearlyFullError as problem:
            return f"the recording ends: {problem}"
        except OSError as problem:
            return f"the recording ends: {problem.filename or ''}: {(problem.strerror or str(problem)).lower()}"
        return ""

    def _report(self, problem: str) -> None:
        self._busy = False
        for path in self._writer.finished[self._announced :]:
            self._print(f"wrote {path}")
        self._announced = len(self._writer.finished)
        if self._left_out:
            names = ", ".join(f"{name} ({count})" for name, count in self._left_out.items())
            self._node.log.warn(f"the disk is too slow; messages left out: {names}")
            self._left_out.clear()
        if problem:
            self._over = True
            self._recorder.record(())
            self._node.end(problem, failed=True)

    def _end(self) -> None:
        messages, self._waiting = self._waiting, []

        def finish() -> str:
            problem = self._store(messages) if messages and not self._over else ""
            try:
                self._writer.finish()
            except OSError as failure:
                return problem or f"{(failure.strerror or str(failure)).lower()}"
            return problem

        self._node.work(finish, self._report_end, _LANE)

    def _report_end(self, problem: str) -> None:
        for path in self._writer.finished[self._announced :]:
            self._print(f"wrote {path}")
        if problem:
            self._node.log.error(problem)

    def _print(self, text: str) -> None:
        sys.stdout.write(f"{text}\n")
        sys.stdout.flush()


def read_settings(parameters: Parameters) -> SplitSettings:
    """The settings of the files."""
    folder = parameters.text("folder", "") or long_recordings_folder(os.environ)
    return SplitSettings(
        Path(folder).expanduser(),
        int(parameters.number("split_megabytes", 500.0, minimum=1.0) * 1e6),
        parameters.number("split_minutes", 10.0, minimum=0.1) * 60.0,
        int(parameters.number("free_megabytes", 500.0, minimum=10.0) * 1e6),
    )


def choose_topics(graph: Graph, patterns: Sequence[str], pictures: bool = True) -> tuple[RecordedTopic, ...]:
    """The topics that fit one of the patterns, with every message.

    Without patterns all: a raw picture is left out where it is published compressed, too, and pictures are taken only
    while another node subscribes to them. Without `pictures`, neither pictures nor clouds.
    """
    if not patterns:
        found = select_topics(graph, wake=False)[:MOST_TOPICS]
        return tuple(replace(each, period=0.0) for each in found if pictures or not each.period)
    topics = [each for each in graph.topics.values() if each.publishers]
    chosen = [each for each in topics if any(fnmatchcase(each.name, pattern) for pattern in patterns)]
    return tuple(RecordedTopic(each.name, each.publishers, type_name=each.kind) for each in chosen[:MOST_TOPICS])
