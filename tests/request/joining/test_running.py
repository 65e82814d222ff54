"""Launches beside nodes that run: what every program of the library offers for it."""

import os

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.world.system import SystemWorld
from ur.request.programs import PACKAGE, Program, find_launch_file, list_programs
from ur.run.join.decision import is_base

PROGRAMS = list_programs(PACKAGE / "bin")


@pytest.mark.parametrize("program", PROGRAMS, ids=[program.name for program in PROGRAMS])
def test_program_leaves_the_robot_alone_with_bring_up_false(program: Program) -> None:
    path = find_launch_file(program)
    assert path is not None
    world = SystemWorld({**os.environ, "ROS_PACKAGE_PATH": f"{PACKAGE}:/usr/share"})
    arguments = ["robot_base:=magni", "robot_variant:=lidar"]
    assert any(is_base(node) for node in load_plan([str(path)], arguments, world).nodes)
    plan = load_plan([str(path)], [*arguments, "bring_up:=false"], world)
    assert not any(each.severity.value == "error" or each.rule == "unknown-argument" for each in plan.diagnostics)
    assert not any(is_base(node) for node in plan.nodes)
