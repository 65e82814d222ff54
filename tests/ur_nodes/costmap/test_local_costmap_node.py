"""The local costmap alone, over real ROS: of a sonar, with the parameters of a base that has no lidar."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ros_session import ROOT, RosSession

pytestmark = [pytest.mark.ros, pytest.mark.timeout(300)]

PARAMETERS = ROOT / "ubiquity_launches" / "n_local_costmap" / "params"


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RosSession]:
    client = [sys.executable, str(Path(__file__).with_name("sonar_client_node.py"))]
    session = RosSession(tmp_path_factory.mktemp("costmap"), client)
    try:
        yield session
    finally:
        session.close()


def start(session: RosSession) -> subprocess.Popen[str]:
    return session.start(
        *(sys.executable, "-m", "ur_nodes", "ur_nodes.costmap.local_costmap_node", "__name:=local_costmap")
    )


def load(session: RosSession, path: Path) -> None:
    command = ["rosparam", "load", str(path), "/local_costmap"]
    subprocess.run(command, env=session.env, check=True, timeout=90, capture_output=True)


def test_costmap_marks_what_a_sonar_hears_where_it_looks_and_forgets_it(session: RosSession) -> None:
    load(session, PARAMETERS / "loki.yaml")
    node = start(session)
    seen = session.ask("echo", distance=1.0, obstacles=True, seconds=60)
    assert seen["frame"] == "odom"
    assert seen["corners"] == 18
    for x, y in seen["at"]:
        assert 0.9 < y < 1.1  # it looks to the left
        assert 2.75 < x < 3.25  # the robot stands at x = 3 m
    assert session.ask("echo", distance=4.0, obstacles=False, seconds=60)["at"] == []
    assert session.stop(node) == ""


def test_parameter_that_makes_no_sense_is_named(session: RosSession, tmp_path: Path) -> None:
    path = tmp_path / "odd.yaml"
    path.write_text("costmap: {resolution: fine, footprint: [[0.1, 0.1], [-0.1, 0], [0.1, -0.1]]}\n", encoding="utf-8")
    load(session, path)
    node = start(session)
    _, errors = node.communicate(timeout=60)
    session.running.remove(node)
    assert "parameter /local_costmap/costmap/resolution: 'fine', expected a number" in errors
    assert node.returncode == 2
