from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from tests.json_client import wait_until
from tests.ros_session import RosSession

from ur.maps.store import own_store
from ur_nodes.geometry.grid import load_map
from ur_nodes.slam.storage.convert import load_poses

PACKAGE = Path(__file__).parents[3] / "ubiquity_launches"
SLAM = PACKAGE / "n_slam_gmapping" / "bin" / "slam_gmapping"
SAVER = PACKAGE / "n_map_saver" / "bin" / "map_saver"


def session(folder: Path, *arguments: str) -> RosSession:
    return RosSession(folder, (sys.executable, "-m", "tests.ur_nodes.slam.slam_client_node", *arguments))


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
@pytest.mark.long
def test_map_is_made_with_a_lidar_that_hangs_upside_down_and_is_turned(tmp_path: Path) -> None:
    ros = session(tmp_path, "odom", "upside-down")
    try:
        ros.start(str(SLAM), "__name:=slam_gmapping", "_base_frame:=base_footprint")
        assert ros.ask("drive", linear=0.2, angular=0.4, seconds=3.0) < 0.03
        assert ros.ask("map")["occupied"] > 100
    finally:
        ros.close()


@pytest.mark.ros
@pytest.mark.long
def test_map_is_made_with_two_lidars_that_see_half_each_and_a_gyroscope(tmp_path: Path) -> None:
    ros = session(tmp_path, "odom", "halves")
    try:
        arguments = ("_base_frame:=base_footprint", "_other_scans:=rear_scan")
        slam = ros.start(str(SLAM), "__name:=slam_gmapping", *arguments)
        assert ros.ask("drive", linear=0.0, angular=0.8, seconds=9.0) < 0.03
        assert ros.ask("map")["occupied"] > 100
        slam.send_signal(signal.SIGINT)
        log = "".join(slam.communicate(timeout=60))
        assert "Traceback" not in log
        assert "no scan on rear_scan" not in log
    finally:
        ros.close()


@pytest.mark.ros
@pytest.mark.long
def test_robot_that_is_carried_elsewhere_while_it_maps_is_found_and_nothing_is_mapped_double(ros: RosSession) -> None:
    slam = ros.start(str(SLAM), "__name:=slam_gmapping", "_base_frame:=base_footprint", "_map_update_interval:=1")
    ros.ask("drive", linear=0.0, angular=0.8, seconds=3.0)
    ros.ask("drive", linear=0.3, angular=0.0, seconds=4.0)
    ros.ask("carry", x=0.0, y=0.0, yaw=-1.0)
    assert ros.ask("drive", linear=0.15, angular=0.5, seconds=8.0) < 0.05
    assert ros.ask("map")["on_walls"] > 0.97
    slam.send_signal(signal.SIGINT)
    log = "".join(slam.communicate(timeout=60))
    assert "lost: looking for the place on the map" in log
    assert "Traceback" not in log


@pytest.mark.ros
@pytest.mark.long
def test_map_of_a_node_that_is_killed_is_whole_and_continued(ros: RosSession, tmp_path: Path) -> None:
    ros.env["XDG_DATA_HOME"] = str(tmp_path / "data")
    store = own_store(ros.env)
    arguments = ("_base_frame:=base_footprint", "_store:=true", "_map_name:=flat", "_save_every:=0.5", "_latest:=true")
    slam = ros.start(str(SLAM), "__name:=slam_gmapping", *arguments)
    ros.ask("drive", linear=0.2, angular=0.0, seconds=2.0)
    wait_until(lambda: store.latest() == "flat", 60.0, "the first stored map")
    ros.ask("drive", linear=0.2, angular=0.0, seconds=2.0)
    slam.send_signal(signal.SIGKILL)
    slam.wait(timeout=60)
    assert store.latest() == "flat"
    poses, edges, scans = load_poses(store.path("flat"), store.record("flat"))
    assert len(poses) == len(scans) == len(edges) + 1
    assert load_map(store.picture("flat")).width > 50
    second = ros.start(str(SLAM), "__name:=second", "_store:=true", "_map_name:=flat")
    with store.claim("flat"):
        _, errors = second.communicate(timeout=60)
    assert second.returncode == 2
    assert "map 'flat' is in use" in errors
    third = ros.start(str(SLAM), "__name:=slam_gmapping", *arguments)
    assert ros.ask("drive", linear=0.2, angular=0.3, seconds=3.0) < 0.05
    third.send_signal(signal.SIGINT)
    _, errors = third.communicate(timeout=60)
    assert third.returncode == 130, errors
    more = load_poses(store.path("flat"), store.record("flat"))[0]
    assert len(more) > len(poses)
    assert np.array(more[: len(poses)]) == pytest.approx(np.array(poses), abs=0.02)


@pytest.mark.ros
def test_bad_parameter_is_refused_in_one_line(ros: RosSession) -> None:
    node = ros.start(str(SLAM), "__name:=slam_gmapping", "_delta:=0")
    _, errors = node.communicate(timeout=60)
    assert node.returncode == 2
    assert "parameter /slam_gmapping/delta: 0, expected a number from 0.01 to 1" in errors
    assert "Traceback" not in errors
