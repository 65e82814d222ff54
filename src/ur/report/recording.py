"""The recording in a report: a copy without secrets."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ur.recordings.mcap_channels import register_channel, start_writer
from ur.recordings.mcap_file import RecordingTopic, open_recording
from ur.recordings.message_types import MessageTypes
from ur.report.secrets import SecretFilter

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
