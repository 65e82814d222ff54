"""Services of Nav2 and slam_toolbox, asked by rclpy's client with their own messages."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.ros2_messages import add_messages
from tests.ros2_session import PYTHON, Ros2Session

from ur.maps.picture_file import write_picture
from ur_nodes.geometry.grid import load_map

pytestmark = [pytest.mark.timeout(300)]
HERE = Path(__file__).parent
MISSING, FAILED = 1, 255


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("services")


@pytest.fixture(scope="module")
def found(folder: Path) -> Iterator[dict[str, Any]]:
    """What the client has printed."""
    if not PYTHON.exists():
        pytest.skip("no wheels of ROS 2 for this processor")
    session = Ros2Session(folder)
    add_messages(session.environment)
    for name, shape in (("first", (3, 4)), ("second", (5, 6))):
        write_picture(folder / name, np.zeros(shape, np.int8), 0.1, (0.0, 0.0, 0.0))
    try:
        session.start("map_server", "ur_nodes.mapping.map_server_node", str(folder / "first.yaml"))
        session.start("slam_gmapping", "ur_nodes.slam.slam_gmapping_node", "map:=made_map")
        session.start("service_server", str(HERE / "service_server.py"))
        program = session.run(str(HERE / "service_client.py"), str(folder), within=200.0)
        assert program.stdout, program.stderr
        yield json.loads(program.stdout.splitlines()[-1])
    finally:
        session.close()


def test_map_is_given_and_another_one_loaded(found: dict[str, Any]) -> None:
    assert found["served"] == [4, 3]
    assert found["loaded"] == [0, 6, 5]
    assert found["missing"] == MISSING


def test_map_is_saved_once_and_not_replaced(found: dict[str, Any], folder: Path) -> None:
    assert found["saved"] == [True, False, False]
    assert load_map(folder / "copy.yaml").shape == (5, 6)


def test_mapping_is_paused_and_its_map_saved_under_the_names_of_slam_toolbox(found: dict[str, Any]) -> None:
    assert found["own"] in (0, FAILED)  # the map of the server, or none yet
    assert found["paused"] is True


def test_pose_is_set_and_costmaps_are_cleared(found: dict[str, Any]) -> None:
    assert "SetInitialPose_Response" in found["placed"]
    assert all("ClearEntireCostmap_Response" in each for each in found["cleared"])
