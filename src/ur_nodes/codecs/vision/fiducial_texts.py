"""Fiducials as JSON in strings. Numbers have the names and units of the values of `ports.fiducials`."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ur_nodes.codecs.text import text_codec
from ur_nodes.geometry.pose import Pose3
from ur_nodes.ports.fiducials import (
    FiducialCorners,
    FiducialPose,
    MappedFiducial,
    MappedFiducials,
    PlacedFiducials,
    SeenFiducials,
)

_LONGEST = 1_000_000  # characters
_Read = Mapping[str, object]
_Numbers = list[float]


def _write_seen(value: SeenFiducials) -> dict[str, object]:
    found = [{"number": each.number, "corners": each.corners.ravel().tolist()} for each in value.fiducials]
    return {"stamp": value.stamp, "frame": value.frame, "picture": value.picture, "fiducials": found}


def _read_seen(read: _Read) -> SeenFiducials:
    found = tuple(
        FiducialCorners(_whole(each["number"]), np.array(_numbers(each["corners"], 8)).reshape(4, 2))
        for each in _listed(read["fiducials"])
    )
    return SeenFiducials(_whole(read["stamp"]), str(read["frame"]), _whole(read["picture"]), found)


def _write_placed(value: PlacedFiducials) -> dict[str, object]:
    found = [
        {
            "number": each.number,
            "pose": list(each.pose),
            "errors": [each.image_error, each.object_error],
            "area": each.area,
        }
        for each in value.fiducials
    ]
    return {"stamp": value.stamp, "frame": value.frame, "picture": value.picture, "fiducials": found}


def _read_placed(read: _Read) -> PlacedFiducials:
    found = []
    for each in _listed(read["fiducials"]):
        pose, errors = Pose3(*_numbers(each["pose"], 7)), _numbers(each["errors"], 2)
        (area,) = _numbers([each["area"]], 1)
        found.append(FiducialPose(_whole(each["number"]), pose, errors[0], errors[1], area))
    return PlacedFiducials(_whole(read["stamp"]), str(read["frame"]), _whole(read["picture"]), tuple(found))


def _write_map(value: MappedFiducials) -> dict[str, object]:
    found = [{"number": each.number, "place": each.place, "angles": each.angles} for each in value.fiducials]
    return {"fiducials": found}


def _read_map(read: _Read) -> MappedFiducials:
    found = []
    for each in _listed(read["fiducials"]):
        (x, y, z), (roll, pitch, yaw) = _numbers(each["place"], 3), _numbers(each["angles"], 3)
        found.append(MappedFiducial(_whole(each["number"]), (x, y, z), (roll, pitch, yaw)))
    return MappedFiducials(tuple(found))


def _listed(value: object) -> list[_Read]:
    if not isinstance(value, list) or not all(isinstance(each, dict) for each in value):
        raise ValueError("fiducials, expected a list of mappings")
    return value


def _whole(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise TypeError(f"{value!r}, expected a whole number")
    return value


def _numbers(value: object, count: int) -> _Numbers:
    if not isinstance(value, list) or len(value) != count:
        raise TypeError(f"{value!r}, expected {count} numbers")
    numbers = [float(each) for each in value]
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"{value!r}, expected finite numbers")
    return numbers


CODECS = {
    SeenFiducials: text_codec("fiducials", _write_seen, _read_seen, _LONGEST),
    PlacedFiducials: text_codec("fiducials", _write_placed, _read_placed, _LONGEST),
    MappedFiducials: text_codec("map of fiducials", _write_map, _read_map, _LONGEST),
}
