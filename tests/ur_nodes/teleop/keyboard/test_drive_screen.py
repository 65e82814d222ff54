import re

import pytest

from ur.source.ansi import BOLD, REVERSE
from ur_nodes.client.mux import MuxView
from ur_nodes.teleop.keyboard.drive import DriveSettings, start_drive, step_drive
from ur_nodes.teleop.keyboard.drive_screen import (
    CommandTopic,
    describe_drive,
    draw_drive_screen,
    draw_map_screen,
    map_room,
)
from ur_nodes.teleop.terminal.keys import Key, KittyFlags

FREE = MuxView(stopped=False)
STATE = start_drive(DriveSettings(0.3, 0.6, 0.5, 1.0))


def plain(lines: list[str]) -> str:
    return "\n".join(re.sub(r"\x1b\[[0-9;]*m", "", line) for line in lines)


def test_screen_shows_speeds_limits_and_topic() -> None:
    text = plain(draw_drive_screen(STATE, CommandTopic("/cmd_vel", 1), FREE, 80, 24))
    assert "0.30 of 0.5 m/s" in text
    assert "0.60 of 1 rad/s" in text
    assert "/cmd_vel · 1 subscriber" in text
    assert "■ stopped" in text


def test_screen_shows_what_is_driven() -> None:
    state, _ = step_drive(STATE, Key("o"), 0.0)
    lines = draw_drive_screen(state, CommandTopic("/cmd_vel", 1), FREE, 80, 24)
    assert "+0.30 m/s  -0.60 rad/s" in plain(lines)
    assert any(f"{REVERSE}{BOLD} o " in line for line in lines)


def test_screen_says_when_nobody_listens() -> None:
    assert "no subscriber on /robot/cmd_vel" in plain(
        draw_drive_screen(STATE, CommandTopic("/robot/cmd_vel", 0), FREE, 80, 24)
    )


def test_screen_says_that_an_emergency_is_on_and_how_it_ends() -> None:
    driving, _ = step_drive(STATE, Key("i"), 0.0)
    text = plain(draw_drive_screen(driving, CommandTopic("/key_vel", 1), MuxView(stopped=True), 80, 24))
    assert "EMERGENCY STOP: r lets the robot drive again" in text
    assert "driving" not in text


@pytest.mark.parametrize(("columns", "rows"), [(80, 24), (39, 8)])
def test_screen_says_when_the_mux_was_not_stopped(columns: int, rows: int) -> None:
    view = MuxView(problem="NOT STOPPED: service /cmd_vel_mux/stop does not answer: is the robot running?")
    assert "NOT STOPPED: service /cmd_vel_mux" in plain(
        draw_drive_screen(STATE, CommandTopic("/k", 1), view, columns, rows)
    )


def test_screen_says_who_else_drives_and_whether_the_keys_go_first() -> None:
    driving, _ = step_drive(STATE, Key("i"), 0.0)
    link = CommandTopic("/key_vel", 1)
    assert "navigation drives\n" in plain(draw_drive_screen(STATE, link, MuxView(False, "navigation"), 80, 24))
    text = plain(draw_drive_screen(driving, link, MuxView(False, "joystick"), 80, 24))
    assert "joystick drives, with priority over these keys" in text
    assert "keyboard drives" not in plain(draw_drive_screen(driving, link, MuxView(False, "keyboard"), 80, 24))


def test_screen_says_that_space_stops_less_where_there_is_no_mux() -> None:
    assert "no cmd_vel_mux" in plain(draw_drive_screen(STATE, CommandTopic("/cmd_vel", 1), MuxView(), 80, 24))


def test_screen_says_how_the_robot_stops() -> None:
    assert "after you let go" in plain(draw_drive_screen(STATE, CommandTopic("/cmd_vel", 1), FREE, 80, 24))
    state, _ = step_drive(STATE, KittyFlags(15), 0.0)
    assert "the robot stops when you let go" in plain(
        draw_drive_screen(state, CommandTopic("/cmd_vel", 1), FREE, 80, 24)
    )


@pytest.mark.parametrize(("columns", "rows"), [(200, 60), (80, 24), (60, 16), (39, 10), (20, 3), (1, 1)])
def test_screen_fits(columns: int, rows: int) -> None:
    lines = draw_drive_screen(STATE, CommandTopic("/cmd_vel", 0), FREE, columns, rows)
    assert len(lines) <= rows
    assert all(len(line) <= columns for line in plain(lines).split("\n"))


def test_small_screen_shows_notes_whole_and_the_keys() -> None:
    view = MuxView(problem="NOT STOPPED: service /cmd_vel_mux/stop does not answer: is the robot running?")
    text = plain(draw_drive_screen(STATE, CommandTopic("/cmd_vel", 1), view, 40, 14))
    assert " ".join(view.problem.split()) in " ".join(text.split())
    for part in ("u   i   o", "m   ,   .", "0.30 m/s", "space: emergency stop", "Ctrl-C: quit"):
        assert part in text


def test_speed_without_a_limit_names_none() -> None:
    state = start_drive(DriveSettings(0.3, 0.6, 1000.0, 1000.0))
    assert (
        " of "
        not in plain(draw_drive_screen(state, CommandTopic("/cmd_vel", 1), FREE, 80, 24)).split("forward")[1][:60]
    )


def test_lines_for_a_dumb_terminal_hold_no_escape_sequence() -> None:
    text = "\n".join(describe_drive(STATE, CommandTopic("/cmd_vel", 0), MuxView(stopped=True)))
    assert "\x1b" not in text
    assert "EMERGENCY STOP: r lets the robot drive again" in text
    assert "no subscriber on /cmd_vel" in text


def test_map_has_all_but_the_lines_about_the_drive_and_a_long_note_covers_its_edge() -> None:
    columns, rows = map_room(60, 24)
    assert (columns, rows) == (60, 19)
    lines = draw_map_screen(STATE, CommandTopic("/cmd_vel", 1), FREE, 60, ["#" * 60] * rows)
    assert len(lines) == 24
    assert "■ stopped" in plain(lines[19:])
    assert "n: save what happened" in plain(lines[19:])
    long = draw_map_screen(STATE, CommandTopic("/cmd_vel" * 12, 0), FREE, 60, ["#" * 60] * rows)
    assert len(long) == 24
    assert "is the robot running?" in plain(long).replace("\n", " ")
    assert map_room(60, 10) == map_room(20, 24) == (0, 0)
