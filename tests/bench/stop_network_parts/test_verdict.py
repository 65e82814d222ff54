"""Verdicts on motion: due to a fresh command, too late, a ghost, or without a record of commands."""

import math
from pathlib import Path

import pytest
from bench.stop_network_parts.lane import ALTERNATING, Lane
from bench.stop_network_parts.verdict import Moving, Verdict, is_at_rest, judge, simulate_base

from ur.robot.base import Base, load_base

LIBRARY = Path(__file__).resolve().parents[3] / "ubiquity_launches"
LINEAR, ANGULAR = Lane("keyboard", "linear", 0.5), Lane("keyboard", "angular", 1.0)


@pytest.fixture(scope="module")
def base() -> Base:
    return load_base(LIBRARY, "magni", "")


def drive(since: float, until: float, forward: float = 0.5, turn: float = 0.0) -> list[tuple[float, float, float]]:
    """Commands at 50 Hz."""
    return [(since + 0.02 * step, forward, turn) for step in range(round((until - since) * 50))]


def moving(since: float, until: float, forward: int = 1, turn: int = 0) -> list[Moving]:
    rest = [Moving(since - 0.01, 0, 0)]
    return [*rest, *(Moving(since + 0.01 * step, forward, turn) for step in range(round((until - since) * 100)))]


def verdict(commands: list[tuple[float, float, float]], motion: list[Moving], lane: Lane = LINEAR) -> Verdict:
    return judge(lane, commands, motion, 0.0)


def test_motion_while_commands_come_is_young() -> None:
    found = verdict(drive(1.0, 3.0), moving(1.1, 3.0))
    assert found.longest < 0.03
    assert found.ghosts == ()


def test_motion_after_the_last_command_counts_from_it() -> None:
    found = verdict(drive(1.0, 3.0), moving(1.1, 3.5))
    assert found.longest == pytest.approx(0.51, abs=0.02)
    assert found.at == pytest.approx(3.49, abs=0.011)
    assert found.ghosts == ()


def test_motion_that_begins_without_a_command_is_a_ghost() -> None:
    found = verdict(drive(1.0, 3.0), [*moving(1.1, 3.1), *moving(13.0, 13.4)])
    assert found.longest < LINEAR.limit
    (ghost,) = found.ghosts
    assert (ghost.began, ghost.direction) == (13.0, "ahead")
    assert ghost.seconds == pytest.approx(0.4, abs=0.02)
    assert ghost.age == pytest.approx(10.02, abs=0.03)


@pytest.mark.parametrize(("forward", "turn", "direction"), [(-1, 0, "back"), (0, 1, "left"), (0, -1, "right")])
def test_motion_that_fits_no_command_is_a_ghost(forward: int, turn: int, direction: str) -> None:
    (ghost,) = verdict(drive(1.0, 3.0), moving(1.5, 2.0, forward, turn)).ghosts
    assert ghost.direction == direction


def test_ghost_of_an_angular_lane_has_the_direction_of_the_base() -> None:
    commands = drive(1.0, 3.0, 0.0, 1.0)
    (back,) = verdict(commands, moving(1.5, 2.0, -1, 0), ANGULAR).ghosts
    (right,) = verdict(commands, moving(1.5, 2.0, 0, -1), ANGULAR).ghosts
    assert (back.direction, right.direction) == ("back", "right")


@pytest.mark.parametrize("commands", [[], drive(1.0, 3.0, 0.0), drive(1.0, 3.0, 0.0, 1.0)])
def test_motion_without_a_recorded_command_is_not_judged(commands: list[tuple[float, float, float]]) -> None:
    found = verdict(commands, moving(1.1, 3.0))
    assert not found.recorded
    assert (found.longest, found.ghosts) == (0.0, ())


def test_missing_record_is_noticed_when_the_base_moved_only_before_the_cause() -> None:
    assert not judge(LINEAR, [], moving(1.1, 3.0), 8.0).recorded


@pytest.mark.parametrize("commands", [[], drive(1.0, 3.0)])
def test_rest_needs_no_record(commands: list[tuple[float, float, float]]) -> None:
    assert verdict(commands, moving(1.1, 3.0, 0)).recorded


def test_motion_that_fits_no_command_is_judged_when_there_is_a_record() -> None:
    found = verdict(drive(1.0, 3.0), moving(1.1, 3.0, -1))
    assert found.recorded
    assert [ghost.age for ghost in found.ghosts] == [math.inf]


def test_motion_that_lasts_into_a_trial_is_due_to_its_command_when_the_record_begins_earlier() -> None:
    commands, motion = drive(1.0, 6.0), moving(4.0, 6.0)
    assert verdict([each for each in commands if each[0] >= 3.0], motion).ghosts == ()
    assert verdict([each for each in commands if each[0] > 4.0], motion).ghosts  # hence a trial begins at rest


@pytest.mark.parametrize(("forward", "turn"), [(0.5, 0.0), (0.0, -0.1)])
def test_base_is_at_rest_once_only_zeros_have_arrived(forward: float, turn: float) -> None:
    outputs = [(1.0, forward, turn), (1.5, 0.0, 0.0), (2.0, 0.0, 0.0)]
    assert not is_at_rest(outputs, 1.0)
    assert is_at_rest(outputs, 1.1)
    assert is_at_rest([], 1.0)


def test_turns_are_what_counts_in_an_angular_lane() -> None:
    assert verdict(drive(1.0, 3.0, 0.0, 1.0), moving(1.1, 3.0, 0, 1), ANGULAR).ghosts == ()


def test_what_was_before_the_trial_does_not_count() -> None:
    found = judge(LINEAR, drive(1.0, 3.0), [*moving(1.1, 4.0), *moving(6.0, 7.0)], 8.0)
    assert (found.longest, found.ghosts) == (0.0, ())


def test_base_follows_its_commands_and_stops_when_they_end(base: Base) -> None:
    motion = simulate_base(base, drive(1.0, 3.0), 5.0)
    moves = [each.at for each in motion if each.forward]
    assert 1.0 < moves[0] < 1.1
    assert 3.0 < moves[-1] < 3.0 + LINEAR.limit
    assert not any(each.turn for each in motion)


def test_pattern_repeats() -> None:
    assert [ALTERNATING.sign_at(seconds) for seconds in (0.0, 1.0, 1.7, 2.6, 3.2, 4.2)] == [1, 0, -1, 0, 1, 0]
