"""Point clouds made small: at most so many points, as whole numbers of a unit around their middle."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

MOST_POINTS = 15_000
"""Points of a cloud that is sent."""

_FARTHEST = 1000.0  # m
_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}  # by the number in PointField
_LARGEST = 1 << 26  # bytes
_VERSION = 1
_HEAD = struct.Struct("<f3fI?")

Points = NDArray[np.float64]
Colours = NDArray[np.uint8]


class BadCloudError(ValueError):
    """A message that is no cloud; the text says why, in a line."""


def unpack_cloud(message: Any, most: int = MOST_POINTS) -> tuple[Points, Colours | None]:
    """The points (n, 3) of a sensor_msgs/PointCloud2 in m, in its frame, and their colours (n, 3) where it has them.

    At most `most`, evenly chosen; those that are not finite or are out of reach are left out. Raises BadCloudError.
    """
    count, step = message.width * message.height, message.point_step
    data = bytes(message.data)
    if not 0 < step <= 4096 or len(data) > _LARGEST:
        raise BadCloudError(f"points of {step} bytes in {len(data)}, expected 1 to 4096 in at most {_LARGEST}")
    if message.height > 1 and message.row_step != message.width * step:
        raise BadCloudError(f"rows of {message.row_step} bytes, expected {message.width * step}")
    if count * step > len(data):
        raise BadCloudError(f"{count} points of {step} bytes, and there are {len(data)} bytes")
    kind = _find_type(message.fields, step, big=message.is_bigendian)
    stride = max(1, -(-count // most))
    table = np.frombuffer(data, kind, count)[::stride]
    points = np.stack([table[name].astype(np.float64) for name in "xyz"], axis=1)
    with np.errstate(invalid="ignore"):
        good = (np.abs(points) < _FARTHEST).all(axis=1)
    colours = None
    if "rgb" in (kind.names or ()):
        packed = np.ascontiguousarray(table["rgb"]).view("u4")[good]
        colours = np.stack([packed >> 16, packed >> 8, packed], axis=1).astype(np.uint8)
    return points[good], colours


def _find_type(fields: Sequence[Any], step: int, *, big: bool) -> np.dtype[Any]:
    """The layout of a point. Raises BadCloudError."""
    order, found = ">" if big else "<", {}
    for field in fields[:64]:
        name = "rgb" if field.name in ("rgb", "rgba") else field.name
        form = _TYPES.get(field.datatype)
        if name in ("x", "y", "z", "rgb") and form is not None and field.offset + np.dtype(form).itemsize <= step:
            found[name] = order + form, field.offset
    if not {"x", "y", "z"} <= found.keys():
        raise BadCloudError("expected the fields x, y and z within a point")
    if "rgb" in found and found["rgb"][0][1:] not in ("f4", "u4"):
        del found["rgb"]
    names = list(found)
    return np.dtype(
        {
            "names": names,
            "formats": [found[name][0] for name in names],
            "offsets": [found[name][1] for name in names],
            "itemsize": step,
        }
    )


def pack_cloud(topic: str, frame: str, points: Points, colours: Colours | None) -> bytes:
    """The bytes for a page: see `static/data/scene_data.js`, which reads them."""
    middle = points.mean(axis=0) if len(points) else np.zeros(3)
    reach = float(np.abs(points - middle).max()) if len(points) else 0.0
    unit = max(reach / 32767.0, 0.001)
    small = np.round((points - middle) / unit).astype("<i2")
    names = b"".join(struct.pack("<B", len(each)) + each for each in (topic.encode()[:255], frame.encode()[:255]))
    head = _HEAD.pack(unit, *middle, len(points), colours is not None)
    return (
        struct.pack("<B", _VERSION) + names + head + small.tobytes() + (b"" if colours is None else colours.tobytes())
    )
