"""Recordings of the black box on the disk: MCAP files, each complete or absent, the newest of them kept."""

import os
import re
import shutil
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from ur.recordings.mcap_channels import dialect_of, register_channel, start_writer
from ur_nodes.black_box.history import HistoryEvent, HistoryMessage, HistoryTopic

FREE_BYTES = 200_000_000
"""Bytes that stay free on the disk."""

_NAME = re.compile(r"black_box_\d{4}-\d\d-\d\d_\d\d-\d\d-\d\d(_\d+)?\.mcap", re.ASCII)


class RecordingError(Exception):
    """The recording was not written; the text is for users."""


def list_recordings(folder: Path) -> list[Path]:
    """List the recordings of a folder, oldest first."""
    with suppress(OSError):
        return sorted(path for path in folder.iterdir() if _NAME.fullmatch(path.name))
    return []


def write_recording(
    folder: Path,
    history: Iterable[HistoryMessage | HistoryEvent],
    reasons: Sequence[str],
    to_unix: int,
    kept: int,
    free: int | None = None,
) -> Path:
    """Write a history, and remove the oldest recordings beyond `kept`.

    `to_unix` converts a time of the history to Unix time, in ns; `free` are the free bytes of the disk, asked for by
    default. Raises RecordingError.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        for path in folder.glob(".black_box_*"):  # of a writer that was killed
            if time.time() - path.stat().st_mtime > 60.0:
                path.unlink(missing_ok=True)
        free = shutil.disk_usage(folder).free if free is None else free
        if free < FREE_BYTES:
            raise RecordingError(f"{folder}: {free // 1_000_000} MB are free, expected {FREE_BYTES // 1_000_000} MB")
        path = _new_path(folder)
        unfinished = folder / f".{path.name}.{os.getpid()}"
        try:
            with unfinished.open("wb") as file:
                os.fchmod(file.fileno(), 0o600)
                _write(file, history, reasons, to_unix)
                file.flush()
                os.fsync(file.fileno())
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)
        for old in list_recordings(folder)[:-kept]:
            old.unlink(missing_ok=True)
    except OSError as problem:
        raise RecordingError(f"{folder}: {(problem.strerror or str(problem)).lower()}") from None
    return path


def _new_path(folder: Path) -> Path:
    stem = time.strftime("black_box_%Y-%m-%d_%H-%M-%S")
    number = 1
    path = folder / f"{stem}.mcap"
    while path.exists():
        number += 1
        path = folder / f"{stem}_{number}.mcap"
    return path


def _write(
    file: BinaryIO, history: Iterable[HistoryMessage | HistoryEvent], reasons: Sequence[str], to_unix: int
) -> None:
    messages = list(history)
    topics = {each.topic for each in messages if isinstance(each, HistoryMessage)}
    dialects = {dialect_of(topic.type_name, topic.schema) for topic in topics} - {""}
    writer = start_writer(file, dialects.pop() if len(dialects) == 1 else "", metadata=True)
    channels: dict[HistoryTopic, int] = {}
    events: dict[str, str] = {}
    sequence = 0
    for each in messages:
        if isinstance(each, HistoryEvent):
            events[f"{(each.time + to_unix) / 1e9:.3f}"] = each.text
            continue
        if each.topic not in channels:
            topic = each.topic
            channels[topic] = register_channel(
                writer, topic.name, topic.type_name, topic.schema, topic.sender, latched=topic.latched
            )
        stamp = max(0, each.time + to_unix)
        sequence += 1
        writer.add_message(channels[each.topic], stamp, each.data, stamp, sequence)
    writer.add_metadata("reasons", {str(number): text for number, text in enumerate(reasons, 1)})
    writer.add_metadata("events", events)
    writer.finish()  # type: ignore[no-untyped-call]
