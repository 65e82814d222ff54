"""The recording in a report: a copy without secrets, and the values that the page shows."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ur.report.secrets import SecretFilter

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mcap.records import Channel, Message, Schema
    from mcap.writer import Writer

_MOST_TEXT = 65_536  # bytes of a message that may hold texts for people
_SECOND = 1e9
_SHOWN = frozenset({"nav_msgs/Odometry", "nav_msgs/OccupancyGrid", "geometry_msgs/PoseWithCovarianceStamped"})
_MOST_POINTS = 2000


@dataclass(frozen=True, slots=True)
class DrawnMap:
    """A map: cells as in nav_msgs/OccupancyGrid, from below; the corner and the size of a cell in m."""

    width: int
    height: int
    resolution: float
    x: float
    y: float
    cells: bytes


@dataclass(slots=True)
class Recording:
    """The content of a page: times in s since 1970, `speeds` and `turns` of the odometry, and `track` in the map.

    `topics` has the number of messages and bytes of each.
    """

    begin: float = 0.0
    end: float = 0.0
    events: list[tuple[float, str]] = field(default_factory=list)
    log: list[tuple[float, str, str]] = field(default_factory=list)
    speeds: list[tuple[float, float]] = field(default_factory=list)
    turns: list[tuple[float, float]] = field(default_factory=list)
    track: list[tuple[float, float]] = field(default_factory=list)
    odometry: list[tuple[float, float]] = field(default_factory=list)
    grid: DrawnMap | None = None
    topics: dict[str, tuple[str, int, int]] = field(default_factory=dict)


def copy_recording(source: Path, target: Path, secrets: SecretFilter) -> Recording:
    """Copy a recording without its secrets, and read what a page shows of it. Raises OSError, ValueError."""
    from mcap.exceptions import McapError
    from mcap.reader import make_reader
    from mcap.writer import CompressionType, Writer
    from rosbags.typesys import Stores, get_typestore

    found = Recording()
    try:
        with source.open("rb") as file, target.open("wb") as copy:
            reader = make_reader(file)
            header = reader.get_header()
            writer = Writer(copy, compression=CompressionType.ZSTD)
            writer.start(profile=header.profile, library=header.library)
            schemas: dict[int, int] = {}
            channels: dict[int, int] = {}
            with_texts: dict[int, bool] = {}
            store = get_typestore(Stores.ROS1_NOETIC)
            for schema, channel, message in reader.iter_messages():
                if channel.id not in channels:
                    channels[channel.id] = _register(writer, schema, channel, schemas)
                    with_texts[channel.id] = schema is not None and _has_texts(schema)
                data = message.data
                if schema is None or (with_texts[channel.id] and len(data) <= _MOST_TEXT):
                    data = secrets.clean_bytes(data, f"recording.mcap: {channel.topic}")
                writer.add_message(channels[channel.id], message.log_time, data, message.publish_time, message.sequence)
                kind, count, size = found.topics.get(channel.topic, ("" if schema is None else schema.name, 0, 0))
                found.topics[channel.topic] = kind, count + 1, size + len(data)
                _note(found, schema, channel, message, data, store)
            for each in reader.iter_metadata():
                values = {key: secrets.clean(value, "recording.mcap") for key, value in each.metadata.items()}
                writer.add_metadata(each.name, values)
                if each.name == "events":
                    found.events += [(float(moment), text) for moment, text in values.items()]
            writer.finish()  # type: ignore[no-untyped-call]
    except McapError as problem:
        raise ValueError(f"{source.name}: {problem or type(problem).__name__}, expected an MCAP file") from None
    found.topics = dict(sorted(found.topics.items()))
    found.events.sort()
    return found


def _register(writer: Writer, schema: Schema | None, channel: Channel, schemas: dict[int, int]) -> int:
    number = 0
    if schema is not None:
        if schema.id not in schemas:
            schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
        number = schemas[schema.id]
    return writer.register_channel(channel.topic, channel.message_encoding, number, dict(channel.metadata))


def _has_texts(schema: Schema) -> bool:
    own = schema.data.partition(b"\n===")[0]
    return any(line.lstrip().startswith(b"string") for line in own.splitlines()) or schema.name == "rosgraph_msgs/Log"


def _note(
    found: Recording, schema: Schema | None, channel: Channel, message: Message, data: bytes, store: object
) -> None:
    """Keep what the page shows of a message; one that cannot be read is left out."""
    moment = message.log_time / _SECOND
    found.begin = min(found.begin or moment, moment)
    found.end = max(found.end, moment)
    if schema is None or channel.message_encoding != "ros1":
        return
    name = schema.name
    if name not in _SHOWN and channel.topic != "/rosout":
        return
    package, _, kind = name.partition("/")
    try:
        value = store.deserialize_ros1(data, f"{package}/msg/{kind}")  # type: ignore[attr-defined]
    except Exception:  # what another program has published
        return
    if name == "rosgraph_msgs/Log":
        level = {1: "debug", 2: "info", 4: "warning", 8: "error", 16: "fatal"}.get(int(value.level), "info")
        found.log.append((moment, level, f"{value.name}: {value.msg}"))
    elif name == "nav_msgs/Odometry" and channel.topic in ("/odom", "/odometry/filtered"):
        found.speeds.append((moment, float(value.twist.twist.linear.x)))
        found.turns.append((moment, float(value.twist.twist.angular.z)))
        place = value.pose.pose.position
        found.odometry.append((float(place.x), float(place.y)))
    elif name == "geometry_msgs/PoseWithCovarianceStamped" and channel.topic == "/amcl_pose":
        place = value.pose.pose.position
        found.track.append((float(place.x), float(place.y)))
    elif name == "nav_msgs/OccupancyGrid" and channel.topic == "/map":
        info = value.info
        corner = info.origin.position
        cells = bytes(value.data.tobytes())
        if info.width * info.height == len(cells):
            found.grid = DrawnMap(
                int(info.width), int(info.height), float(info.resolution), float(corner.x), float(corner.y), cells
            )


def thin(points: Iterable[tuple[float, float]], most: int = _MOST_POINTS) -> list[tuple[float, float]]:
    """Return at most `most` points of a curve, and its last one."""
    given = list(points)
    step = max(1, -(-len(given) // most))
    return [*given[::step], *given[-1:]] if given else []
