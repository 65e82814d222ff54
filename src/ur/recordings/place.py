"""The place of the robot in a recording, and the map that it had."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

from ur.recordings.mcap_file import RecordingFile
from ur.recordings.message_types import MessageTypes
from ur.source.diagnostic import UserError, error_about

_MAP, _ODOM = "map", "odom"
_BASES = ("base_footprint", "base_link")
_TOPICS = frozenset({"/tf", "/tf_static", "/map"})


class _Vector(Protocol):
    x: float
    y: float


class _Quaternion(_Vector, Protocol):
    z: float
    w: float


class _Origin(Protocol):
    position: _Vector
    orientation: _Quaternion


class _MapInfo(Protocol):
    width: int
    height: int
    resolution: float
    origin: _Origin


class _Cells(Protocol):
    def tobytes(self) -> bytes: ...


class MapMessage(Protocol):
    """A nav_msgs/OccupancyGrid."""

    info: _MapInfo
    data: _Cells


class _Header(Protocol):
    frame_id: str


class _Transform(Protocol):
    translation: _Vector
    rotation: _Quaternion


class _StampedTransform(Protocol):
    header: _Header
    child_frame_id: str
    transform: _Transform


class _Transforms(Protocol):
    transforms: Sequence[_StampedTransform]


@dataclass(frozen=True, slots=True)
class RecordedMap:
    """A map: cells as in nav_msgs/OccupancyGrid, from below; the size of a cell in m, and the pose of its corner."""

    width: int
    height: int
    resolution: float
    origin: tuple[float, float, float]
    cells: bytes


@dataclass(frozen=True, slots=True)
class RecordedPlace:
    """The pose of the robot in the map: m, m, rad."""

    x: float
    y: float
    yaw: float
    map: RecordedMap


def find_place(recording: RecordingFile, seconds: float | None) -> RecordedPlace:
    """Find where the robot was so many seconds after the start; None: at the end.

    Raises UserError: the recording has no map, or no pose of the robot in it.
    """
    until = recording.end if seconds is None else recording.start + int(seconds * 1e9)
    poses: dict[tuple[str, str], tuple[float, float, float]] = {}
    newest: RecordedMap | None = None
    types = MessageTypes()
    for message in recording.messages(topics=_TOPICS):
        if message.time > until:
            break
        try:
            value = types.decode(message.topic, message.data)
            if message.topic.name == "/map":
                newest = read_map(value)
            else:
                poses.update(_read_transforms(value))
        except (ValueError, AttributeError):  # a type of that name with other fields
            continue
    base = next((each for each in _BASES if (_ODOM, each) in poses), None)
    missing = "map on /map" if newest is None else "pose of the robot in the map on /tf"
    if newest is None or base is None or (_MAP, _ODOM) not in poses:
        text = f"holds no {missing}, expected both: the robot was not localised"
        help_ = "'ur replay FILE PROGRAM' plays it"
        raise UserError(error_about(str(recording.path), text, rule="no-place", help=help_))
    x, y, yaw = _compose(poses[_MAP, _ODOM], poses[_ODOM, base])
    return RecordedPlace(x, y, yaw, newest)


def read_map(value: MapMessage) -> RecordedMap:
    """Read a map. Raises ValueError: it has another number of cells."""
    info = value.info
    cells = bytes(value.data.tobytes())
    if info.width * info.height != len(cells):
        raise ValueError("a map of another size")
    place = info.origin
    origin = (float(place.position.x), float(place.position.y), _yaw(place.orientation))
    return RecordedMap(int(info.width), int(info.height), float(info.resolution), origin, cells)


def _read_transforms(value: _Transforms) -> Iterator[tuple[tuple[str, str], tuple[float, float, float]]]:
    for each in value.transforms:
        place = each.transform.translation
        names = (each.header.frame_id.lstrip("/"), each.child_frame_id.lstrip("/"))
        yield names, (float(place.x), float(place.y), _yaw(each.transform.rotation))


def _yaw(turn: _Quaternion) -> float:
    return math.atan2(2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y**2 + turn.z**2))


def _compose(first: tuple[float, float, float], second: tuple[float, float, float]) -> tuple[float, float, float]:
    cosine, sine = math.cos(first[2]), math.sin(first[2])
    return (
        first[0] + cosine * second[0] - sine * second[1],
        first[1] + sine * second[0] + cosine * second[1],
        math.remainder(first[2] + second[2], math.tau),
    )
