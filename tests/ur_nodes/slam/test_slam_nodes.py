import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from tests.json_client import wait_until
from tests.ros_session import RosSession

from ur.maps.store import MapStore, own_store
from ur.source.diagnostic import UserError
from ur.source.project import launch_library
from ur_nodes.geometry.grid import load_map
from ur_nodes.slam.storage.writer import load_poses

SLAM = launch_library() / "n_slam_gmapping" / "bin" / "slam_gmapping"
SAVER = launch_library() / "n_map_saver" / "bin" / "map_saver"


@pytest.fixture
def ros(tmp_path: Path) -> Iterator[RosSession]:
    started = RosSession(tmp_path, (sys.executable, "-m", "tests.ur_nodes.slam.slam_client_node"))
    yield started
    started.close()


@pytest.mark.ros
def test_robot_drives_in_the_simulator_and_the_map_is_published_and_saved(ros: RosSession, tmp_path: Path) -> None:
    ros.start(str(SLAM), "__name:=slam_gmapping", "_base_frame:=base_footprint")
    assert ros.ask("drive", linear=0.0, angular=0.8, seconds=2.0) < 0.02
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


def count_poses(store: MapStore) -> int:
    """The keyframes of the stored map; 0 while the node replaces it."""
    try:
        return len(load_poses(store.path("flat"), store.record("flat"))[0])
    except UserError:
        return 0


@pytest.mark.ros
def test_map_of_a_node_that_is_killed_is_whole_and_continued(ros: RosSession, tmp_path: Path) -> None:
    ros.env["XDG_DATA_HOME"] = str(tmp_path / "data")
    store = own_store(ros.env)
    arguments = ("_base_frame:=base_footprint", "_store:=true", "_map_name:=flat", "_save_every:=0.5", "_latest:=true")
    slam = ros.start(str(SLAM), "__name:=slam_gmapping", *arguments)
    ros.ask("drive", linear=0.2, angular=0.0, seconds=2.0)
    wait_until(lambda: store.latest() == "flat", 60.0, "the first stored map")
    ros.ask("drive", linear=0.2, angular=0.0, seconds=2.0)
    wait_until(lambda: count_poses(store) > 1, 60.0, "its second keyframe")
    slam.send_signal(signal.SIGKILL)
    slam.wait(timeout=60)
    assert store.latest() == "flat"
    poses, edges, scans = load_poses(store.path("flat"), store.record("flat"))
    assert len(poses) == len(scans) > 1
    # Each keyframe is tied to one before it; the slower the drive, the more edges between neighbours come on top.
    assert [edge.after for edge in edges if not edge.robust] == [*range(1, len(poses))]
    assert all(max(edge.before, edge.after) < len(poses) for edge in edges)
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
