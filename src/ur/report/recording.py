"""The recording in a report: a copy without secrets, and the values that the page shows."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ur.recordings.mcap_channels import register_channel, start_writer
from ur.recordings.mcap_file import RecordingTopic, StoredMessage, open_recording
from ur.recordings.message_types import MessageTypes
from ur.recordings.place import RecordedMap, read_map
from ur.report.secrets import SecretFilter

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mcap.writer import Writer

_MOST_TEXT = 65_536  # bytes of a message that may hold texts for people
_SECOND = 1e9
_LEVELS = {1: "debug", 2: "info", 4: "warning", 8: "error", 16: "fatal"}
_LEVELS |= {10: "debug", 20: "info", 30: "warning", 40: "error", 50: "fatal"}  # of ROS 2
_MOST_POINTS = 2000
_SHOWN = {
    "/rosout": "Log",
    "/odom": "Odometry",
    "/odometry/filtered": "Odometry",
    "/amcl_pose": "PoseWithCovarianceStamped",
    "/map": "OccupancyGrid",
}
"""The topics that a page shows, and the type that each must have."""


@dataclass(slots=True)
class Recording:
    """The content of a page: times in s since 1970, `speeds` and `turns` of the odometry, and `track` in the map.

    `topics` has the type of each, and the number of its messages and bytes.
    """

    begin: float = 0.0
    end: float = 0.0
    events: list[tuple[float, str]] = field(default_factory=list)
    log: list[tuple[float, str, str]] = field(default_factory=list)
    speeds: list[tuple[float, float]] = field(default_factory=list)
    turns: list[tuple[float, float]] = field(default_factory=list)
    track: list[tuple[float, float]] = field(default_factory=list)
    odometry: list[tuple[float, float]] = field(default_factory=list)
    grid: RecordedMap | None = None
    topics: dict[str, tuple[str, int, int]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Copied:
    """A topic in the copy, the number of its channel, and what is done with its messages."""

    topic: RecordingTopic
    channel: int
    has_texts: bool
    shown: bool


def copy_recording(source: Path, target: Path, secrets: SecretFilter) -> Recording:
    """Copy a recording without its secrets, with ROS 2's types, and read what a page shows of it.

    Messages that cannot be converted are left out. Raises OSError, UserError.
    """
    original = open_recording(source)
    types = MessageTypes()
    found = Recording(original.start / _SECOND, original.end / _SECOND)
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
            _, count, size = found.topics.get(topic.name, ("", 0, 0))
            found.topics[topic.name] = topic.type_name, count + 1, size + len(data)
            if known.shown:
                _show(found, StoredMessage(known.topic, message.time, data), types)
        for name, values in original.metadata.items():
            cleaned = {key: secrets.clean(value, "recording.mcap") for key, value in values.items()}
            writer.add_metadata(name, cleaned)
            if name == "events":
                found.events = read_events(cleaned)
        writer.finish()  # type: ignore[no-untyped-call]
    found.topics = dict(sorted(found.topics.items()))
    return found


def read_events(events: Mapping[str, str]) -> list[tuple[float, str]]:
    """Read the metadata `events` of a recording: times in s since 1970, and texts, by time."""
    found = []
    for moment, text in events.items():
        with suppress(ValueError):
            found.append((float(moment), text))
    return sorted(found)


def _register(writer: Writer, topic: RecordingTopic, types: MessageTypes) -> _Copied:
    made = types.convert_topic(topic, "ros2")
    channel = register_channel(writer, made.name, made.type_name, made.schema, made.sender, latched=made.latched)
    own = topic.schema.partition("\n===")[0]
    has_texts = (
        not topic.type_name
        or topic.type_name.endswith("/Log")
        or any(line.lstrip().startswith("string") for line in own.splitlines())
    )
    return _Copied(made, channel, has_texts, _SHOWN.get(made.name) == made.type_name.rpartition("/")[2])


def _show(found: Recording, message: StoredMessage, types: MessageTypes) -> None:
    """Keep what the page shows of a message; one that cannot be read is left out."""
    moment = message.time / _SECOND
    try:
        value = types.decode(message.topic, message.data)
        match message.topic.name:
            case "/rosout":
                found.log.append((moment, _LEVELS.get(int(value.level), "info"), f"{value.name}: {value.msg}"))
            case "/map":
                found.grid = read_map(value)
            case "/amcl_pose":
                place = value.pose.pose.position
                found.track.append((float(place.x), float(place.y)))
            case _:
                speed, place = value.twist.twist, value.pose.pose.position
                found.speeds.append((moment, float(speed.linear.x)))
                found.turns.append((moment, float(speed.angular.z)))
                found.odometry.append((float(place.x), float(place.y)))
    except (ValueError, AttributeError):  # a type of that name with other fields
        return


def thin(points: Iterable[tuple[float, float]], most: int = _MOST_POINTS) -> list[tuple[float, float]]:
    """Return at most `most` points of a curve, and its last one."""
    given = list(points)
    step = max(1, -(-len(given) // most))
    return [*given[::step], *given[-1:]] if given else []
