"""Simulator, mux and a driver on ROS 2, each in a process of its own."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from tests.ros2_session import Ros2Session

DRIVER = str(Path(__file__).with_name("driver.py"))
MUX = "ur_nodes.motion.cmd_vel_mux_node"
SOURCES = ("_topics/keyboard/topic:=key_vel", "_topics/keyboard/timeout:=0.15", "_topics/keyboard/priority:=90")
MUX_ARGUMENTS = ("_base:=stage", "_obstacle_stop:=true", "cmd_vel_out:=cmd_vel", *SOURCES)


def drive(session: Ros2Session, *arguments: str) -> dict[str, Any]:
    program = session.run("-m", "ur_nodes", DRIVER, *arguments, within=30.0)
    assert program.stdout, program.stderr
    found: dict[str, Any] = json.loads(program.stdout.splitlines()[-1])
    return found


@pytest.mark.timeout(60)
def test_robot_drives_by_a_twist_through_the_mux_until_it_is_stopped(session: Ros2Session, tmp_path: Path) -> None:
    session.start("simulator", "ur_nodes.simulator.simulator_node", "_base:=stage")
    mux = session.start("cmd_vel_mux", MUX, *MUX_ARGUMENTS)
    driven = drive(session)
    assert driven["stopped"] is False
    assert 0.3 <= driven["moved"] < 0.5
    assert driven["answered"]
    session.kill(mux)
    session.start("cmd_vel_mux", MUX, *MUX_ARGUMENTS)
    blocked = drive(session)
    assert blocked["stopped"] is True
    assert blocked["sent"] > 20
    assert blocked["moved"] < 0.02
    printed = (tmp_path / "simulator.txt").read_text() + (tmp_path / "cmd_vel_mux.txt").read_text()
    assert "Traceback" not in printed
    assert "rcutils" not in printed


@pytest.mark.timeout(60)
def test_mux_that_reads_twist_changes_to_the_twist_stamped_that_a_program_sends(session: Ros2Session) -> None:
    session.start("simulator", "ur_nodes.simulator.simulator_node", "_base:=stage", "cmd_vel:=cmd_vel_base")
    mux = session.start(
        "cmd_vel_mux", MUX, "_base:=stage", "cmd_vel_out:=cmd_vel_base", "_takes_over:=cmd_vel", *SOURCES
    )
    assert drive(session, "_stamped:=true")["moved"] >= 0.3
    assert mux.poll() is None
