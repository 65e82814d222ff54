"""`ur maps merge`, with the process that merges."""

import math
import os

import pytest
from tests.ur_nodes.slam.drives import drive
from tests.ur_nodes.slam.storage.test_merging import put, store

from ur.cli.main import main
from ur.maps.store import MapStore
from ur.maps.waypoint_file import read_places, waypoint_path, write_places
from ur_nodes.geometry.pose import Pose2

__all__ = ["store"]


@pytest.mark.ros
def test_merged_map_has_the_waypoints_of_both(store: MapStore, capsys: pytest.CaptureFixture[str]) -> None:
    put(store, "hall", -2.0, 1.6)
    put(store, "attic", 2.2, -0.6)
    write_places(waypoint_path("hall", os.environ), {"door": (0.5, 0.0, 90.0)})
    write_places(waypoint_path("attic", os.environ), {"door": (9.0, 9.0, 0.0), "sofa": (-0.2, 0.3, 0.0)})
    assert main(["maps", "merge", "hall", "attic", "--as", "house"]) == 0
    assert "of hall: door" in capsys.readouterr().out
    places = read_places(waypoint_path("house", os.environ))
    assert places["door"] == (0.5, 0.0, 90.0)
    hall, attic = drive(-2.0, 1.6)[0], drive(2.2, -0.6)[0]  # where their maps begin in the world
    sofa = hall.inverse().compose(attic).compose(Pose2(-0.2, 0.3, 0.0))
    assert places["sofa"] == pytest.approx((sofa.x, sofa.y, math.degrees(sofa.yaw)), abs=0.1)
    assert store.names() == ["attic", "hall", "house"]


def test_map_is_not_merged_with_itself(store: MapStore, capsys: pytest.CaptureFixture[str]) -> None:
    put(store, "hall", -2.0, 1.6)
    assert main(["maps", "merge", "hall", "hall", "--as", "house"]) == 2
    assert "same-map" in capsys.readouterr().err
    assert store.names() == ["hall"]
