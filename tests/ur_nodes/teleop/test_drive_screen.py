from __future__ import annotations

import re

import pytest

from ur_nodes.teleop.drive import DriveSettings, start_drive, step_drive
from ur_nodes.teleop.drive_screen import Link, draw_drive_screen
from ur_nodes.teleop.keys import Key, KittyFlags

STATE = start_drive(DriveSettings(0.3, 0.6, 0.5, 1.0))


def plain(lines: list[str]) -> str:
    return "\n".join(re.sub(r"\x1b\[[0-9;]*m", "", line) for line in lines)


def test_screen_shows_speeds_limits_and_topic() -> None:
    text = plain(draw_drive_screen(STATE, Link("/cmd_vel", 1), 80, 24))
    assert "0.30 of 0.5 m/s" in text
    assert "0.60 of 1 rad/s" in text
    assert "/cmd_vel · 1 listener" in text
    assert "standing still" in text


def test_screen_shows_what_is_driven() -> None:
    state, _ = step_drive(STATE, Key("o"), 0.0)
    lines = draw_drive_screen(state, Link("/cmd_vel", 1), 80, 24)
    assert "+0.30 m/s  -0.60 rad/s" in plain(lines)
    assert any("\x1b[7;1m o " in line for line in lines)


def test_screen_says_when_nobody_listens() -> None:
    assert "nobody listens to /robot/cmd_vel" in plain(draw_drive_screen(STATE, Link("/robot/cmd_vel", 0), 80, 24))


def test_screen_says_how_the_robot_stops() -> None:
    assert "after you let go" in plain(draw_drive_screen(STATE, Link("/cmd_vel", 1), 80, 24))
    state, _ = step_drive(STATE, KittyFlags(15), 0.0)
    assert "let go and the robot stops" in plain(draw_drive_screen(state, Link("/cmd_vel", 1), 80, 24))


@pytest.mark.parametrize(("columns", "rows"), [(200, 60), (80, 24), (60, 16), (39, 10), (20, 3), (1, 1)])
def test_screen_fits(columns: int, rows: int) -> None:
    lines = draw_drive_screen(STATE, Link("/cmd_vel", 0), columns, rows)
    assert len(lines) <= rows
    assert all(len(line) <= columns for line in plain(lines).split("\n"))
