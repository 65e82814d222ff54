"""Fiducials as JSON in strings. Numbers have the names and units of the values of `ports.fiducials`."""

from dataclasses import dataclass

import numpy as np

from ur_nodes.codecs.text import converted_codec, text_codec
from ur_nodes.ports.fiducials import FiducialCorners, MappedFiducials, SeenFiducials, StampedFiducials

_LONGEST = 1_000_000  # characters
_Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class _Corners:
    number: int
    corners: tuple[_Point, _Point, _Point, _Point]


@dataclass(frozen=True, slots=True)
class _Seen:
    stamp: int
    frame: str
    picture: int
    fiducials: tuple[_Corners, ...]


def _write_seen(value: SeenFiducials) -> _Seen:
    found = tuple(_Corners(each.number, tuple(map(tuple, each.corners.tolist()))) for each in value.fiducials)  # type: ignore[arg-type]  # four rows of two
    return _Seen(value.stamp, value.frame, value.picture, found)


def _read_seen(read: _Seen) -> SeenFiducials:
    found = tuple(FiducialCorners(each.number, np.array(each.corners, float)) for each in read.fiducials)
    return SeenFiducials(read.stamp, read.frame, read.picture, found)


CODECS = {
    SeenFiducials: converted_codec("fiducials", _Seen, _write_seen, _read_seen, _LONGEST),
    StampedFiducials: text_codec("fiducials", StampedFiducials, _LONGEST),
    MappedFiducials: text_codec("map of fiducials", MappedFiducials, _LONGEST),
}
