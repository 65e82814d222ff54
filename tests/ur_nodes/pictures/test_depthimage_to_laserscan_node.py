import math

import numpy as np
import pytest

from ur.source.diagnostic import UserError
from ur_nodes.memory.bus import Bus
from ur_nodes.pictures.depthimage_to_laserscan_node import ScanSettings, make_scan, read_depth, start
from ur_nodes.ports.values import Calibration, Picture, Scan

MATRIX = (50.0, 0.0, 40.0, 0.0, 50.0, 30.0, 0.0, 0.0, 1.0)
UNIT = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
CAMERA = Calibration(0, "depth", 81, 60, "plumb_bob", (0.0,) * 5, MATRIX, UNIT, (*MATRIX, 0.0, 0.0, 0.0))
SETTINGS = ScanSettings(4, 0.1, 0.45, 5.0, "laser")


def picture(depths: np.ndarray, encoding: str = "32FC1") -> Picture:
    data = depths.astype("<f4") if encoding == "32FC1" else np.round(depths * 1000.0).astype("<u2")
    return Picture(7, "depth", depths.shape[1], depths.shape[0], encoding, data.strides[0], data.tobytes())


def test_wall_ahead_is_a_line_in_the_scan() -> None:
    scan = make_scan(np.full((60, 81), 2.0), CAMERA, SETTINGS, 5)
    angles = scan.angle_min + scan.angle_increment * np.arange(81)
    seen = np.isfinite(scan.ranges)
    assert seen.sum() > 60
    assert scan.ranges[seen] * np.cos(angles[seen]) == pytest.approx(2.0, abs=0.03)
    assert (scan.stamp, scan.frame) == (5, "laser")
    assert scan.angle_max == pytest.approx(math.atan(0.8))


def test_thing_on_the_right_of_the_picture_is_on_the_right_of_the_scan() -> None:
    depths = np.full((60, 81), 4.0)
    depths[30, 70:75] = 1.0
    scan = make_scan(depths, CAMERA, SETTINGS, 0)
    angles = scan.angle_min + scan.angle_increment * np.arange(81)
    near = np.nan_to_num(scan.ranges, nan=9.0) < 2.0
    assert near.any()
    assert angles[near].max() < 0.0


def test_far_is_free_and_without_depth_or_too_near_is_no_reading() -> None:
    depths = np.full((60, 81), 9.0)
    depths[:, 40] = 0.0
    depths[:, 20] = 0.1
    ranges = make_scan(depths, CAMERA, SETTINGS, 0).ranges
    assert np.isposinf(ranges).sum() > 50
    assert np.isnan(ranges[40])


def test_rows_outside_of_the_band_do_not_count() -> None:
    depths = np.full((60, 81), 3.0)
    depths[:20] = 1.0
    assert np.nanmin(make_scan(depths, CAMERA, SETTINGS, 0).ranges) > 2.9


@pytest.mark.parametrize("encoding", ["16UC1", "32FC1"])
def test_depths_are_read_in_both_encodings(encoding: str) -> None:
    depths = read_depth(picture(np.array(((1.5, 0.0), (2.25, 3.0))), encoding))
    assert depths is not None
    assert depths.tolist() == [[1.5, 0.0], [2.25, 3.0]]


def test_other_pictures_have_no_depth() -> None:
    assert read_depth(Picture(0, "", 2, 2, "rgb8", 6, bytes(12))) is None
    assert read_depth(Picture(0, "", 2, 2, "32FC1", 8, bytes(12))) is None


def test_node_publishes_a_scan_for_each_picture_after_the_calibration() -> None:
    bus = Bus()
    bus.load_parameters("/scanner", {"scan_height": 4, "output_frame": "eye", "range_max": 5.0})
    node, camera = bus.node("scanner"), bus.node("camera")
    scans: list[Scan] = []
    start(node)
    camera.subscribe("scan", Scan, scans.append)
    pictures, infos = camera.publish("image", Picture), camera.publish("camera_info", Calibration)
    pictures.send(picture(np.full((60, 81), 2.0)))
    bus.run(0.1)
    assert not scans
    infos.send(CAMERA)
    bus.run(0.1)
    for encoding in ("rgb8", "32FC1"):
        pictures.send(
            picture(np.full((60, 81), 2.0)) if encoding == "32FC1" else Picture(0, "", 1, 1, encoding, 3, b"000")
        )
        bus.run(0.1)
    assert [scan.frame for scan in scans] == ["eye"]


def test_unusable_limits_end_the_node() -> None:
    bus = Bus()
    bus.load_parameters("/scanner", {"range_min": 2.0, "range_max": 1.0})
    with pytest.raises(UserError, match="range_max"):
        start(bus.node("scanner"))
