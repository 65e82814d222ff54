"""From a description to a goal that the robot reaches, for what tests/documents, with two wheels and a lidar, lacks."""

import os
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT
from tests.e2e.test_programs import run_command
from tests.robot.description.urdfs import DEPTH, FOUR_WHEELS

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]


def test_skid_steer_of_a_description_reaches_a_goal_in_the_office(tmp_path: Path) -> None:
    reach_a_goal(tmp_path, FOUR_WHEELS)


def test_robot_with_a_depth_camera_and_no_lidar_reaches_a_goal_in_the_office(tmp_path: Path) -> None:
    assert "by depthimage_to_laserscan" in reach_a_goal(tmp_path, DEPTH)


def reach_a_goal(tmp_path: Path, description: str) -> str:
    """Make a base of a description and send it to a goal; what was read of the description."""
    (tmp_path / "rover.urdf").write_text(description, encoding="utf-8")
    speeds = ("--velocity", "0.5", "--angular-velocity", "1.2")
    words = ("new", "base", "rover", "--from", "rover.urdf", "--workspace", "own", *speeds)
    made = run_command(tmp_path, str(ROOT / "ur"), *words, keys="")
    assert made.returncode == 0, made.stderr
    prefixes = os.pathsep.join(filter(None, [str(tmp_path / "own"), os.environ.get("CMAKE_PREFIX_PATH", "")]))
    command = "g 1 0 0"
    program = ("run", "keyboard_navigate", "robot_base:=rover", "world:=office")
    done = run_command(
        tmp_path, "env", f"CMAKE_PREFIX_PATH={prefixes}", str(ROOT / "ur"), *program, keys=f"{command}\n"
    )
    assert done.stdout.startswith(f"{command}: reached, "), done.stderr
    assert done.returncode == 0
    return made.stderr
