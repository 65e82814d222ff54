"""Services of Nav2, asked by rclpy's client with their own messages."""

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

pytestmark = [pytest.mark.timeout(300)]
HERE = Path(__file__).parent
MISSING = 1


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


def test_costmaps_are_cleared(found: dict[str, Any]) -> None:
    assert all("ClearEntireCostmap_Response" in each for each in found["cleared"])
