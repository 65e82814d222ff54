from __future__ import annotations

import re

import pytest

from ur_nodes.teleop.drive import DriveSettings, start_drive, step_drive
from ur_nodes.teleop.drive_screen import Link, draw_drive_screen
from ur_nodes.teleop.emergency import MuxView
from ur_nodes.teleop.keys import Key, KittyFlags

FREE = MuxView(stopped=False)
STATE = start_drive(DriveSettings(0.3, 0.6, 0.5, 1.0))


def plain(lines: list[str]) -> str:
    return "\n".join(re.sub(r"\x1b\[[0-9;]*m", "", line) for line in lines)


def test_screen_shows_speeds_limits_and_topic() -> None:
    text = plain(draw_drive_screen(STATE, Link("/cmd_vel", 1), FREE, 80, 24))
    assert "0.30 of 0.5 m/s" in text
    assert "0.60 of 1 rad/s" in text
    assert "/cmd_vel · 1 listener" in text
    assert "standing still" in text


def test_screen_shows_what_is_driven() -> None:
    state, _ = step_drive(STATE, Key("o"), 0.0)
    lines = draw_drive_screen(state, Link("/cmd_vel", 1), FREE, 80, 24)
    assert "+0.30 m/s  -0.60 rad/s" in plain(lines)
    assert any("\x1b[7;1m o " in line for line in lines)


def test_screen_says_when_nobody_listens() -> None:
    assert "nobody listens to /robot/cmd_vel" in plain(
        draw_drive_screen(STATE, Link("/robot/cmd_vel", 0), FREE, 80, 24)
    )


def test_screen_says_that_an_emergency_is_on_and_how_it_ends() -> None:
    driving, _ = step_drive(STATE, Key("i"), 0.0)
    text = plain(draw_drive_screen(driving, Link("/key_vel", 1), MuxView(stopped=True), 80, 24))
    assert "EMERGENCY STOP: r lets the robot drive again" in text
    assert "driving" not in text


@pytest.mark.parametrize(("columns", "rows"), [(80, 24), (39, 8)])
def test_screen_says_when_the_mux_was_not_stopped(columns: int, rows: int) -> None:
    view = MuxView(problem="NOT STOPPED: service /cmd_vel_mux/stop does not answer: is the robot running?")
    assert "NOT STOPPED: service /cmd_vel_mux" in plain(draw_drive_screen(STATE, Link("/k", 1), view, columns, rows))


def test_screen_says_who_else_drives_and_whether_the_keys_go_first() -> None:
    driving, _ = step_drive(STATE, Key("i"), 0.0)
    link = Link("/key_vel", 1)
    assert "navigation drives\n" in plain(draw_drive_screen(STATE, link, MuxView(False, "navigation"), 80, 24))
    text = plain(draw_drive_screen(driving, link, MuxView(False, "joystick"), 80, 24))
    assert "joystick drives, and goes before these keys" in text
    assert "drives" not in plain(draw_drive_screen(driving, link, MuxView(False, "keyboard"), 80, 24))


def test_screen_says_that_space_stops_less_where_there_is_no_mux() -> None:
    assert "no mux is there" in plain(draw_drive_screen(STATE, Link("/cmd_vel", 1), MuxView(), 80, 24))


def test_screen_says_how_the_robot_stops() -> None:
    assert "after you let go" in plain(draw_drive_screen(STATE, Link("/cmd_vel", 1), FREE, 80, 24))
    state, _ = step_drive(STATE, KittyFlags(15), 0.0)
    assert "let go and the robot stops" in plain(draw_drive_screen(state, Link("/cmd_vel", 1), FREE, 80, 24))


@pytest.mark.parametrize(("columns", "rows"), [(200, 60), (80, 24), (60, 16), (39, 10), (20, 3), (1, 1)])
def test_screen_fits(columns: int, rows: int) -> None:
    lines = draw_drive_screen(STATE, Link("/cmd_vel", 0), FREE, columns, rows)
    assert len(lines) <= rows
    assert all(len(line) <= columns for line in plain(lines).split("\n"))
