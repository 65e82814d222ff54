import math

import pytest

from ur_nodes.geometry.rigid import from_angles, to_pose
from ur_nodes.vision.detect import Sizes
from ur_nodes.vision.map_output import make_map, make_markers

POSE = from_angles((1.0, 2.0, 3.0), (0.1, 0.2, 0.3))


def test_markers_are_a_plate_and_a_number_above_it() -> None:
    shown = make_markers({4: POSE}, Sizes(0.14, {4: 0.3}), "map")
    plate, number = shown.markers
    assert (shown.frame, plate.namespace, number.namespace, number.text) == ("map", "fiducials", "numbers", "4")
    assert plate.pose == to_pose(POSE)
    assert plate.size == (0.3, 0.3, 0.01)
    assert number.pose.z == pytest.approx(3.3)


def test_map_has_places_and_angles_by_number() -> None:
    entries = make_map({7: POSE, 4: POSE}).fiducials
    assert [each.number for each in entries] == [4, 7]
    assert entries[0].position == (1.0, 2.0, 3.0)
    assert math.dist(entries[0].angles, (0.1, 0.2, 0.3)) < 1e-9
