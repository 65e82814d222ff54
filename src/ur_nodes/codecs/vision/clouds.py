"""Clouds of points, whose memory is that of the message."""

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2, PointField

from ur_nodes.codecs.codec import LARGE, Codec, fill_header, frame_of
from ur_nodes.codecs.dialect import stamp_of
from ur_nodes.ports.values import PointCloud

_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}  # by the number in PointField
_TYPE_OF = {name: number for number, name in _TYPES.items()}
_LONGEST_POINT = 4096  # bytes
_MOST_FIELDS = 64
_COLOURS = ("rgb", "rgba")


def _fill_cloud(message: PointCloud2, value: PointCloud) -> None:
    fill_header(message, value.stamp, value.frame)
    kind = value.points.dtype
    parts = [(name, *kind.fields[name][:2]) for name in kind.names or ()] if kind.fields else []
    message.fields = [
        PointField(name=name, offset=offset, datatype=_TYPE_OF[part.str[1:]], count=1) for name, part, offset in parts
    ]
    message.is_bigendian = any(part.str.startswith(">") for _, part, _ in parts)
    message.height, message.width, message.point_step = 1, len(value.points), kind.itemsize
    message.row_step, message.is_dense = kind.itemsize * len(value.points), False
    message.data = np.ascontiguousarray(value.points).tobytes()


def _cloud_of(message: PointCloud2) -> PointCloud:
    count, step = message.width * message.height, message.point_step
    if not 0 < step <= _LONGEST_POINT:
        raise ValueError(f"points of {step} bytes, expected 1 to {_LONGEST_POINT}")
    if message.height > 1 and message.row_step != message.width * step:
        raise ValueError(f"rows of {message.row_step} bytes, expected {message.width * step}")
    if count * step > len(message.data):
        raise ValueError(f"{count} points of {step} bytes, and there are {len(message.data)} bytes")
    points: NDArray[np.void] = np.frombuffer(message.data, _layout_of(message), count)
    return PointCloud(stamp_of(message.header.stamp), frame_of(message), points)


def _layout_of(message: PointCloud2) -> np.dtype[np.void]:
    order, step = ">" if message.is_bigendian else "<", message.point_step
    found: dict[str, tuple[str, int]] = {}
    for field in message.fields[:_MOST_FIELDS]:
        form = _TYPES.get(field.datatype, "")
        if not form or field.offset + np.dtype(form).itemsize > step:
            continue
        if field.name in ("x", "y", "z"):
            found[field.name] = order + form, field.offset
        elif field.name in _COLOURS and form in ("f4", "u4"):  # the bytes of a float are the colour
            found["rgb"] = order + "u4", field.offset
    if not {"x", "y", "z"} <= found.keys():
        raise ValueError("expected the fields x, y and z within a point")
    formats, offsets = [form for form, _ in found.values()], [offset for _, offset in found.values()]
    return np.dtype({"names": list(found), "formats": formats, "offsets": offsets, "itemsize": step})


CODECS = {PointCloud: Codec(PointCloud2, _fill_cloud, _cloud_of, LARGE)}
