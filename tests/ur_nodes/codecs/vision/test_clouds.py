"""Point clouds of any layout, and messages that are none."""

from __future__ import annotations

import struct
from typing import Any

import pytest

pytest.importorskip("rospy", reason="ROS is not installed")

from sensor_msgs.msg import PointCloud2, PointField

from ur_nodes.codecs import find_codec
from ur_nodes.ports.values import PointCloud

XYZ = [PointField(name, 4 * at, 7, 1) for at, name in enumerate("xyz")]
read = find_codec(PointCloud).value_of


def make(count: int, **more: Any) -> PointCloud2:
    data = b"".join(struct.pack("<fffI", n, 2.0, 3.0, 0x102030) for n in range(count))
    fields = [*XYZ, PointField("rgb", 12, 6, 1)]
    given: dict[str, Any] = {"data": data, "width": count, "height": 1, "point_step": 16, "fields": fields}
    return PointCloud2(**given | more)


def test_points_and_colours_are_read_without_a_copy() -> None:
    message = make(3)
    points = read(message).points
    assert [points[name].tolist() for name in "xyz"] == [[0, 1, 2], [2, 2, 2], [3, 3, 3]]
    assert points["rgb"].tolist() == [0x102030] * 3
    assert points.base is not None


def test_colour_in_the_bytes_of_a_float_is_read() -> None:
    points = read(make(1, fields=[*XYZ, PointField("rgba", 12, 7, 1)])).points
    assert points["rgb"].tolist() == [0x102030]


@pytest.mark.parametrize(
    "changes",
    [
        {"point_step": 0},
        {"point_step": 100_000},
        {"width": 2**32 - 1},
        {"height": 2, "row_step": 5},
        {"fields": XYZ[:2]},
        {"fields": [PointField("x", 14, 7, 1), *XYZ[1:]]},
        {"fields": [PointField("x", 2**32 - 1, 7, 1), *XYZ[1:]]},
        {"fields": [PointField("x", 0, 77, 1), *XYZ[1:]]},
    ],
)
def test_cloud_whose_layout_is_wrong_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"expected|there are"):
        read(make(4, **changes))


def test_empty_cloud_and_one_of_other_numbers_are_read() -> None:
    assert read(make(0)).points.shape == (0,)
    fields = [PointField(name, 8 * at, 8, 1) for at, name in enumerate("xyz")]
    data = struct.pack(">ddd", 1, 2, 3)
    big = read(make(1, data=data, point_step=24, is_bigendian=True, fields=fields)).points
    assert big.tolist() == [(1.0, 2.0, 3.0)]
    assert [big[name].astype(float).tolist() for name in "xyz"] == [[1], [2], [3]]
