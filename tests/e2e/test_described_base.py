"""From the description of a robot to a goal that it reaches, as docs/how-to/robot-of-your-own.md says."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT
from tests.e2e.test_programs import run_command
from tests.robot.description.urdfs import FOUR_WHEELS, SMALL

pytestmark = [pytest.mark.ros, pytest.mark.long, pytest.mark.timeout(300)]


@pytest.mark.parametrize(
    ("text", "velocity", "goal"),
    [(SMALL, "0.22", ("world:=maze", "g 0.5 0 0")), (FOUR_WHEELS, "0.5", ("world:=office", "g 1 0 0"))],
    ids=["small", "four_wheels"],
)
def test_robot_of_a_description_reaches_a_goal(tmp_path: Path, text: str, velocity: str, goal: tuple[str, str]) -> None:
    (tmp_path / "rover.urdf").write_text(text, encoding="utf-8")
    speeds = ("--velocity", velocity, "--angular-velocity", "1.2")
    words = ("new", "base", "rover", "--from", "rover.urdf", "--workspace", "own", *speeds)
    made = run_command(tmp_path, str(ROOT / "ur"), *words, keys="")
    assert made.returncode == 0, made.stderr
    prefixes = os.pathsep.join(filter(None, [str(tmp_path / "own"), os.environ.get("CMAKE_PREFIX_PATH", "")]))
    world, command = goal
    program = ("run", "keyboard_navigate", "robot_base:=rover", world)
    done = run_command(
        tmp_path, "env", f"CMAKE_PREFIX_PATH={prefixes}", str(ROOT / "ur"), *program, keys=f"{command}\n"
    )
    assert done.stdout.startswith(f"{command}: reached, "), done.stderr
    assert done.returncode == 0
