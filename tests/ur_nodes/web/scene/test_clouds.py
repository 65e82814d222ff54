"""Point clouds made small."""

import struct

import numpy as np
from numpy.typing import NDArray

from ur_nodes.web.scene.feed import pack_cloud, thin_cloud

KIND = [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<u4")]


def make(rows: list[tuple[float, float, float]]) -> NDArray[np.void]:
    return np.array([(*row, 0x102030) for row in rows], KIND)


def test_points_and_colours_are_read() -> None:
    points, colours = thin_cloud(make([(0, 2, 3), (1, 2, 3)]))
    assert points.tolist() == [[0, 2, 3], [1, 2, 3]]
    assert colours is not None
    assert colours.tolist() == [[16, 32, 48]] * 2
    assert thin_cloud(make([(0, 2, 3)])[["x", "y", "z"]])[1] is None
    assert thin_cloud(make([]))[0].shape == (0, 3)


def test_large_cloud_is_thinned_evenly() -> None:
    points, _ = thin_cloud(make([(n, 2, 3) for n in range(1000)]), most=100)
    assert points[:, 0].tolist() == list(range(0, 1000, 10))


def test_points_that_are_not_finite_or_far_are_left_out() -> None:
    points, colours = thin_cloud(make([(float("nan"), 0, 0), (float("inf"), 0, 0), (1e30, 0, 0), (1, 1, 1)]))
    assert points.tolist() == [[1, 1, 1]]
    assert colours is not None
    assert len(colours) == 1


def test_packed_cloud_is_exact_to_a_millimetre_and_no_text() -> None:
    points = np.array([[100.0, 2.0, 3.0], [101.0, 2.5, 3.0]])
    body = pack_cloud("/cloud", "laser", points, None)
    assert body[:8] == b"\x01\x06/cloud"
    unit, x, y, z, count, coloured = struct.unpack_from("<f3fI?", body, 14)
    numbers = np.frombuffer(body, "<i2", 6, 14 + 21).reshape(-1, 3)
    assert np.abs([x, y, z] + unit * numbers - points).max() < 0.001
    assert (count, coloured) == (2, False)
    assert pack_cloud("/c", "", np.zeros((0, 3)), None)
