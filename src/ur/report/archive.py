"""The archive of a report: one zip, complete or absent, without secrets."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ur.recordings.mcap_channels import register_channel, start_writer
from ur.recordings.mcap_file import RecordingTopic, open_recording
from ur.recordings.message_types import MessageTypes
from ur.report.secrets import SecretFilter
from ur.report.sources import RunSources, write_values
from ur.source.diagnostic import UserError
from ur.source.replace import PRIVATE, output_file

if TYPE_CHECKING:
    from mcap.writer import Writer

_MOST_TEXT = 65_536  # bytes of a message that may hold texts for people


@dataclass(frozen=True, slots=True)
class _Copied:
    """A topic in the copy, the number of its channel, and what is done with its messages."""

    topic: RecordingTopic
    channel: int
    has_texts: bool


def copy_recording(source: Path, target: Path, secrets: SecretFilter) -> None:
    """Copy a recording without its secrets, with ROS 2's types.

    Messages that cannot be converted are left out. Raises OSError, UserError.
    """
    original = open_recording(source)
    types = MessageTypes()
    copied: dict[RecordingTopic, _Copied] = {}
    with target.open("wb") as copy:
        made = [types.convert_topic(each, "ros2") for each in original.topics.values()]
        profile = "ros2" if all(each.encoding == "cdr" for each in made) else ""
        writer = start_writer(copy, profile, metadata=bool(original.metadata))
        for message in original.messages():
            topic = message.topic
            known = copied.get(topic)
            if known is None:
                known = copied[topic] = _register(writer, topic, types)
            data = message.data
            if known.has_texts and len(data) <= _MOST_TEXT:
                data = secrets.clean_bytes(data, f"recording.mcap: {topic.name}")
            try:
                data = types.convert(topic, known.topic, data)
            except ValueError:
                continue
            writer.add_message(known.channel, message.time, data, message.time)
        for name, values in original.metadata.items():
            cleaned = {key: secrets.clean(value, "recording.mcap") for key, value in values.items()}
            writer.add_metadata(name, cleaned)
        writer.finish()  # type: ignore[no-untyped-call]


def _register(writer: Writer, topic: RecordingTopic, types: MessageTypes) -> _Copied:
    made = types.convert_topic(topic, "ros2")
    channel = register_channel(writer, made.name, made.type_name, made.schema, made.sender, latched=made.latched)
    own = topic.schema.partition("\n===")[0]
    has_texts = (
        not topic.type_name
        or topic.type_name.endswith("/Log")
        or any(line.lstrip().startswith("string") for line in own.splitlines())
    )
    return _Copied(made, channel, has_texts)


MOST_BYTES = 20_000_000
ZIP = b"PK"  # the beginning of an archive


@dataclass(frozen=True, slots=True)
class Report:
    """A report that was written: its bytes, a line for each kind of removed secrets and file, and what is missing."""

    path: Path
    size: int
    removed: tuple[str, ...]
    missing: tuple[str, ...]


def write_report(path: Path, sources: RunSources, recordings: Sequence[Path], unreadable: str = "") -> Report:
    """Write the archive. `recordings` are files of the black box, newest last, of which the newest is taken.

    `unreadable` is the reason why recordings cannot be read on this computer, '' where they can.
    Raises UserError.
    """
    secrets = SecretFilter()
    for tree in sources.values.values():
        secrets.learn(tree)
        secrets.learn_text(write_values(tree))
    for text in sources.texts.values():
        secrets.learn_text(text)
    missing = []
    with tempfile.TemporaryDirectory(prefix=".ur_report_", dir=path.parent) as folder:
        copy = Path(folder, "recording.mcap")
        if unreadable:
            missing.append(f"the recording: {unreadable}")
        elif recordings:
            try:
                copy_recording(recordings[-1], copy, secrets)
            except (OSError, UserError) as problem:
                missing.append(f"the recording: {problem}")
                copy.unlink(missing_ok=True)
        else:
            missing.append("a recording: the black box has written none during the run")
        if copy.exists() and copy.stat().st_size > MOST_BYTES * 3 // 4:
            copy.unlink()
            missing.append("the recording: it is too large")
        files = {name: write_values(secrets.clean_values(tree, name)) for name, tree in sources.values.items() if tree}
        for name, text in sources.texts.items():
            files[name] = secrets.clean(text, name)
        removed = tuple(f"{file}: {count} times a {kind}" for (file, kind), count in sorted(secrets.removed.items()))
        files["removed.txt"] = "\n".join([*removed, *(f"missing: {each}" for each in missing)]) + "\n"
        with (
            output_file(path, recordings, ZIP, mode=PRIVATE) as file,
            zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive,
        ):
            for name, text in files.items():
                archive.writestr(name, text)
            if copy.exists():
                archive.write(copy, "recording.mcap", zipfile.ZIP_STORED)
    return Report(path, path.stat().st_size, removed, tuple(missing))


def list_run_recordings(folder: Path, begin: float, end: float) -> list[Path]:
    """The recordings of a folder that were written in a time (s since 1970), oldest first."""
    found: list[tuple[float, Path]] = []
    with suppress(OSError):
        paths = [each for each in folder.iterdir() if each.suffix == ".mcap" and not each.name.startswith(".")]
        found = [(each.stat().st_mtime, each) for each in paths]
    return [each for moment, each in sorted(found) if begin <= moment <= end]
