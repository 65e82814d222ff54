"""Point clouds made small, and those that are none."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from ur_nodes.web.scene.clouds import BadCloudError, pack_cloud, unpack_cloud


@dataclass
class PointField:
    name: str
    offset: int
    datatype: int = 7


XYZ = [PointField("x", 0), PointField("y", 4), PointField("z", 8)]


@dataclass
class Message:
    data: bytes
    width: int
    height: int = 1
    point_step: int = 16
    row_step: int = 0
    is_bigendian: bool = False
    fields: list[PointField] = field(default_factory=lambda: [*XYZ, PointField("rgb", 12, 6)])


def make(count: int, **more: Any) -> Message:
    data = b"".join(struct.pack("<fffI", n, 2.0, 3.0, 0x102030) for n in range(count))
    return Message(data, count, **more)


def test_points_and_colours_are_read() -> None:
    points, colours = unpack_cloud(make(3))
    assert points.tolist() == [[0, 2, 3], [1, 2, 3], [2, 2, 3]]
    assert colours is not None
    assert colours.tolist() == [[16, 32, 48]] * 3


def test_large_cloud_is_thinned_evenly() -> None:
    points, _ = unpack_cloud(make(1000), most=100)
    assert points[:, 0].tolist() == list(range(0, 1000, 10))


def test_points_that_are_not_finite_or_far_are_left_out() -> None:
    rows = [(float("nan"), 0, 0), (float("inf"), 0, 0), (1e30, 0, 0), (1, 1, 1)]
    message = Message(b"".join(struct.pack("<fffI", *row, 0) for row in rows), 4)
    points, colours = unpack_cloud(message)
    assert points.tolist() == [[1, 1, 1]]
    assert colours is not None
    assert len(colours) == 1


@pytest.mark.parametrize(
    "changes",
    [
        {"point_step": 0},
        {"point_step": 100_000},
        {"width": 2**32 - 1},
        {"height": 2, "row_step": 5},
        {"fields": XYZ[:2]},
        {"fields": [PointField("x", 14), *XYZ[1:]]},
        {"fields": [PointField("x", 2**32 - 1), *XYZ[1:]]},
        {"fields": [PointField("x", 0, 77), *XYZ[1:]]},
    ],
)
def test_cloud_whose_layout_is_wrong_is_refused(changes: dict[str, Any]) -> None:
    message = make(4)
    for name, value in changes.items():
        setattr(message, name, value)
    with pytest.raises(BadCloudError):
        unpack_cloud(message)


def test_empty_cloud_and_one_of_other_numbers_are_read() -> None:
    assert unpack_cloud(Message(b"", 0))[0].shape == (0, 3)
    big = Message(struct.pack(">ddd", 1, 2, 3), 1, point_step=24, is_bigendian=True)
    big.fields = [PointField(name, 8 * at, 8) for at, name in enumerate("xyz")]
    assert unpack_cloud(big)[0].tolist() == [[1, 2, 3]]


def test_packed_cloud_is_exact_to_a_millimetre_and_no_text() -> None:
    points = np.array([[100.0, 2.0, 3.0], [101.0, 2.5, 3.0]])
    body = pack_cloud("/cloud", "laser", points, None)
    assert body[:8] == b"\x01\x06/cloud"
    unit, x, y, z, count, coloured = struct.unpack_from("<f3fI?", body, 14)
    numbers = np.frombuffer(body, "<i2", 6, 14 + 21).reshape(-1, 3)
    assert np.abs([x, y, z] + unit * numbers - points).max() < 0.001
    assert (count, coloured) == (2, False)
    assert pack_cloud("/c", "", np.zeros((0, 3)), None)
