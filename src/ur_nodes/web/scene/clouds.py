"""Point clouds in a compact form: a bounded number of points, as integers of a unit around their middle."""

import struct

import numpy as np
from numpy.typing import NDArray

MOST_POINTS = 15_000
"""Points of a cloud that is sent."""

_FARTHEST = 1000.0  # m
_VERSION = 1
_HEAD = struct.Struct("<f3fI?")

Points = NDArray[np.float64]
Colours = NDArray[np.uint8]


def thin_cloud(cloud: NDArray[np.void], most: int = MOST_POINTS) -> tuple[Points, Colours | None]:
    """Return points (n, 3) of a `PointCloud` in m, and their colours (n, 3) if it has colours.

    At most `most` points, evenly chosen; points that are not finite or are too far away are left out.
    """
    table = cloud[:: max(1, -(-len(cloud) // most))]
    points = np.stack([table[name].astype(np.float64) for name in "xyz"], axis=1)
    with np.errstate(invalid="ignore"):
        good = (np.abs(points) < _FARTHEST).all(axis=1)
    colours = None
    if "rgb" in (cloud.dtype.names or ()):
        packed = table["rgb"][good]
        colours = np.stack([packed >> 16, packed >> 8, packed], axis=1).astype(np.uint8)
    return points[good], colours


def pack_cloud(topic: str, frame: str, points: Points, colours: Colours | None) -> bytes:
    """Pack points for a page; `static/data/scene_data.js` reads the bytes."""
    middle = points.mean(axis=0) if len(points) else np.zeros(3)
    reach = float(np.abs(points - middle).max()) if len(points) else 0.0
    unit = max(reach / 32767.0, 0.001)
    small = np.round((points - middle) / unit).astype("<i2")
    names = b"".join(struct.pack("<B", len(each)) + each for each in (topic.encode()[:255], frame.encode()[:255]))
    head = _HEAD.pack(unit, *middle, len(points), colours is not None)
    return (
        struct.pack("<B", _VERSION) + names + head + small.tobytes() + (b"" if colours is None else colours.tobytes())
    )
