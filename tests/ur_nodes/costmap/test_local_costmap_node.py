"""The local costmap alone, on a bus: of a sonar, with the parameters of a base that has no lidar."""

import math
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.json_client import wait_until
from tests.ros_session import ROOT, RosSession

from ur.source.diagnostic import UserError
from ur.source.foreign.yaml_text import load_yaml
from ur_nodes.costmap.local_costmap_node import start
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.values import Map, Outline, Range, Transform

PARAMETERS = ROOT / "ubiquity_launches" / "n_local_costmap" / "params"
PLACE, MOUNT = Pose2(3.0, 0.0, 0.0), Pose2(0.0, 0.0, math.pi / 2)  # the sonar looks to the left


class SonarStage:
    """A robot with one sonar, which stands still."""

    def __init__(self, parameters: dict[str, Any]) -> None:
        self.bus = Bus()
        self.bus.load_parameters("/local_costmap", parameters)
        self.robot = self.bus.node("robot")
        self.sonar = self.robot.publish("sonars", Range)
        self.grids: list[Map] = []
        self.outlines: list[Outline] = []
        self.robot.subscribe("local_costmap/costmap/costmap", Map, self.grids.append)
        self.robot.subscribe("local_costmap/costmap/footprint", Outline, self.outlines.append)
        self.costmap = self.bus.node("local_costmap")

    def hear(self, distance: float, times: int = 10, frame: str = "sonar_0") -> None:
        for _ in range(times):
            now = self.bus.now
            self.robot.transforms.send(
                Transform(now, "odom", "base_footprint", PLACE.in_space()),
                Transform(now, "base_footprint", "sonar_0", MOUNT.in_space()),
            )
            self.sonar.send(Range(now, frame, distance, 0.3, 0.02, 4.0))
            self.bus.run(0.1)

    def obstacles(self) -> NDArray[np.float64]:
        """Places (n, 2) in m."""
        grid = self.grids[-1].grid
        return grid.points_of_cells(np.argwhere(grid.values == 100))


def load(name: str) -> dict[str, Any]:
    return dict(load_yaml((PARAMETERS / name).read_text(encoding="utf-8")))


def test_costmap_marks_what_a_sonar_hears_where_it_looks_and_forgets_it() -> None:
    stage = SonarStage(load("loki.yaml"))
    start(stage.costmap)
    stage.hear(1.0)
    found = stage.obstacles()
    assert len(found)
    assert (abs(found - (3.0, 1.0)) < (0.25, 0.1)).all()
    assert stage.grids[-1].frame == "odom"
    assert stage.outlines[-1].corners.shape == (18, 2)
    assert stage.outlines[-1].corners.mean(axis=0) == pytest.approx((3.0, 0.0), abs=0.1)
    stage.hear(4.0)
    assert len(stage.obstacles()) == 0
    assert stage.costmap.lines == []


def test_costmap_names_the_frame_of_data_that_it_cannot_place() -> None:
    stage = SonarStage(load("loki.yaml"))
    start(stage.costmap)
    stage.hear(1.0, times=120, frame="unknown")
    assert stage.costmap.lines[0] == ("warn", "data of unknown ignored: no transform from unknown to odom")
    assert len(stage.costmap.lines) <= 2, "once in ten seconds"


def test_parameter_that_makes_no_sense_is_named() -> None:
    stage = SonarStage({"costmap": {"resolution": "fine"}})
    with pytest.raises(UserError, match="parameter /local_costmap/costmap/resolution: 'fine', expected a number"):
        start(stage.costmap)


@pytest.mark.ros
def test_costmap_offers_the_topics_of_upstream(tmp_path: Path) -> None:
    session = RosSession(tmp_path)
    try:
        load_parameters = ["rosparam", "load", str(PARAMETERS / "loki.yaml"), "/local_costmap"]
        subprocess.run(load_parameters, env=session.env, check=True, timeout=90, capture_output=True)
        program = ROOT / "ubiquity_launches" / "n_local_costmap" / "bin" / "costmap_2d_node"
        node = session.start(str(program), "__name:=local_costmap")
        offered = {
            ("/local_costmap/costmap/costmap", "nav_msgs/OccupancyGrid"),
            ("/local_costmap/costmap/footprint", "geometry_msgs/PolygonStamped"),
        }
        wait_until(lambda: offered <= session.published(), 60.0, "the topics")
        assert session.stop(node) == ""
    finally:
        session.close()
