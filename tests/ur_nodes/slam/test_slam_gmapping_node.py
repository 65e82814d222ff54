from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from tests.ros_session import RosSession

from ur_nodes.geometry.grid import load_map

PACKAGE = Path(__file__).parents[3] / "ubiquity_launches"
SLAM = PACKAGE / "n_slam_gmapping" / "bin" / "slam_gmapping"
SAVER = PACKAGE / "n_map_saver" / "bin" / "map_saver"


def session(folder: Path, child: str) -> RosSession:
    return RosSession(folder, (sys.executable, "-m", "tests.ur_nodes.slam.slam_client_node", child))


@pytest.fixture
def ros(tmp_path: Path) -> Iterator[RosSession]:
    started = session(tmp_path, "odom")
    yield started
    started.close()


@pytest.mark.ros
def test_robot_drives_in_the_simulator_and_the_map_is_published_and_saved(ros: RosSession, tmp_path: Path) -> None:
    ros.start(str(SLAM), "__name:=slam_gmapping", "_base_frame:=base_footprint")
    assert ros.ask("drive", linear=0.0, angular=0.8, seconds=3.0) < 0.02
    assert ros.ask("drive", linear=0.0, angular=-0.8, seconds=3.0) < 0.02
    found = ros.ask("map")
    assert found["frames"] == ["map", "map"]
    assert found["resolution"] == 0.05
    assert found["occupied"] > 100
    assert found["free"] > 500
    saver = ros.start(str(SAVER), "-f", str(tmp_path / "flat"))
    output, errors = saver.communicate(timeout=60)
    assert saver.returncode == 0, errors
    assert f"as {tmp_path / 'flat.yaml'}" in output
    grid = load_map(tmp_path / "flat.yaml")
    assert int(np.sum(grid.values == 100)) > 100


@pytest.mark.ros
def test_map_is_made_without_odometry(tmp_path: Path) -> None:
    ros = session(tmp_path, "base_footprint")
    try:
        ros.start(str(SLAM), "__name:=slam_gmapping", "_base_frame:=base_footprint", "_odom_frame:=''")
        assert ros.ask("drive", linear=0.2, angular=0.3, seconds=3.0) < 0.03
    finally:
        ros.close()


@pytest.mark.ros
def test_bad_parameter_is_refused_in_one_line(ros: RosSession) -> None:
    node = ros.start(str(SLAM), "__name:=slam_gmapping", "_delta:=0")
    _, errors = node.communicate(timeout=60)
    assert node.returncode == 2
    assert "parameter /slam_gmapping/delta: 0, expected a number from 0.01 to 1" in errors
    assert "Traceback" not in errors
