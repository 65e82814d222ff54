import contextlib
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.source.diagnostic import UserError
from ur_nodes.teleop.navigate.commands import (
    CancelGoal,
    Command,
    DrivePatrol,
    Forget,
    Go,
    GoToWaypoint,
    Help,
    ListPlaces,
    Quit,
    Relocalise,
    Remember,
    SetPose,
    error_line,
    parse_command,
)


@pytest.mark.parametrize(
    ("line", "command"),
    [
        ("g 2 3", Go(2.0, 3.0)),
        ("  g  -2.5   3e0  90 ", Go(-2.5, 3.0, math.pi / 2)),
        ("go 1 2", Go(1.0, 2.0)),
        ("m kitchen", GoToWaypoint("kitchen")),
        ("w küche_2", Remember("küche_2")),
        ("patrol sofa hall", DrivePatrol("start", ("sofa", "hall"))),
        ("patrol loop wait=2.5 sofa", DrivePatrol("start", ("sofa",), True, 2.5)),
        ("patrol pause", DrivePatrol("pause")),
        ("patrol end", DrivePatrol("end")),
        ("d kitchen", Forget("kitchen")),
        ('w "living room" # where the sofa is', Remember("living room")),
        ("m 'living room'", GoToWaypoint("living room")),
        ("l", ListPlaces()),
        ("s", CancelGoal()),
        ("i 1 2 180", SetPose(1.0, 2.0, math.pi)),
        ("global", Relocalise()),
        ("?", Help()),
        ("q", Quit()),
        ("s # at once", CancelGoal()),
        ("", None),
        ("# only a comment", None),
    ],
)
def test_line_is_understood(line: str, command: Command | None) -> None:
    assert parse_command(line) == command


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("g 2 x", "'x' is not a number, expected: g X Y [ANGLE]"),
        ("g 2", "'g' needs more than '2', expected: g X Y [ANGLE]"),
        ("g", "'g' needs arguments, expected: g X Y [ANGLE]"),
        ("g 1 2 3 4", "unexpected '4', expected: g X Y [ANGLE]"),
        ("g nan 1", "'nan' is not a number"),
        ("g 1 inf", "'inf' is not a number"),
        ("s now", "unexpected 'now', expected: s"),
        ("i 1 2", "'i' needs more than '1 2', expected: i X Y ANGLE"),
        ("w a/b", "'a/b' is not a valid name"),
        ("w my place", "unexpected 'place', expected: w NAME (w \"my place\")"),
        ('w "my place', "has an opening quote without a closing one"),
        ('w " place"', "' place' is not a valid name"),
        ("m", "'m' needs arguments, expected: m NAME"),
        ("patrol", "'patrol' needs arguments, expected: patrol [loop] NAME ..."),
        ("patrol loop", "'patrol' needs arguments, expected: patrol [loop] NAME ..."),
        ("patrol wait=x sofa", "'x' is not a number, expected: patrol"),
        ("patrol wait=-1 sofa", "wait=-1: expected seconds from 0 to 3600"),
        ("patrol a/b", "'a/b' is not a valid name"),
        ("globl", "did you mean 'global'?"),
        ("foo", "unknown command 'foo', expected g X Y, m NAME"),
        ("\x1b[2J", "unknown command '\\\\x1b[2J'"),
        ("z", "unknown command 'z', expected g X Y, m NAME"),
    ],
)
def test_error_names_the_value_and_what_was_expected(line: str, message: str) -> None:
    with pytest.raises(UserError) as caught:
        parse_command(line)
    assert message in error_line(caught.value)
    assert "\n" not in error_line(caught.value)


@given(st.text(max_size=60))
def test_any_text_is_a_command_or_a_user_error(line: str) -> None:
    with contextlib.suppress(UserError):
        parse_command(line)
