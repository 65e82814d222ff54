from __future__ import annotations

import pytest

from ur_nodes.teleop.goal_tracker import (
    ANSWER_LIMIT,
    Status,
    Tracker,
    track_current,
    track_result,
    track_sent,
    track_status,
    track_time,
)
from ur_nodes.teleop.navigator import GoalState, Place

HERE, THERE = Place(1.0, 2.0, 0.0), Place(5.0, 6.0, 0.0)
PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, REJECTED = range(6)


def sent() -> Tracker:
    return track_sent(Tracker(), "a", HERE, 0.0)


def test_goal_goes_from_sent_over_driving_to_reached() -> None:
    tracker = sent()
    assert tracker.report.state is GoalState.WAITING
    tracker = track_status(tracker, (Status("a", ACTIVE, ""),), 0.1)
    assert tracker.report.state is GoalState.DRIVING
    tracker = track_result(tracker, Status("a", SUCCEEDED, "Goal reached."), 9.0)
    assert (tracker.report.state, tracker.report.over) == (GoalState.REACHED, True)


def test_failure_passes_on_the_reason() -> None:
    report = track_result(sent(), Status("a", ABORTED, "the goal is in a wall"), 1.0).report
    assert (report.state, report.text) == (GoalState.FAILED, "the goal is in a wall")
    assert track_result(sent(), Status("a", REJECTED, ""), 1.0).report.text == "move_base gave no reason"


def test_result_that_got_lost_is_seen_in_the_status_list() -> None:
    assert track_status(sent(), (Status("a", PREEMPTED, ""),), 1.0).report.state is GoalState.STOPPED


def test_what_happens_to_other_goals_changes_nothing() -> None:
    assert track_result(sent(), Status("b", ABORTED, "no"), 1.0) == sent()
    assert track_status(sent(), (Status("b", ACTIVE, ""),), 1.0).report == sent().report


def test_new_goal_has_the_next_number_and_ignores_the_old_result() -> None:
    tracker = track_sent(sent(), "b", THERE, 1.0)
    assert tracker.report.number == 2
    assert track_result(tracker, Status("a", PREEMPTED, ""), 1.1).report.state is GoalState.WAITING


def test_goal_that_a_restarted_move_base_does_not_know_fails() -> None:
    tracker = track_status(sent(), (), 1.0)
    assert tracker.report.state is GoalState.WAITING
    tracker = track_status(tracker, (), ANSWER_LIMIT + 0.1)
    assert tracker.report.state is GoalState.FAILED
    assert "restarted" in tracker.report.text


def test_silence_fails_the_goal() -> None:
    assert track_time(sent(), ANSWER_LIMIT).report.state is GoalState.WAITING
    assert "does not answer" in track_time(sent(), ANSWER_LIMIT + 0.1).report.text


def test_goal_from_elsewhere_is_followed() -> None:
    tracker = track_current(Tracker(), THERE, 0.0)
    assert (tracker.report.number, tracker.report.state) == (1, GoalState.DRIVING)
    tracker = track_status(tracker, (Status("old", SUCCEEDED, ""), Status("rviz", ACTIVE, "")), 0.2)
    assert tracker.goal_id == "rviz"
    assert track_result(tracker, Status("rviz", SUCCEEDED, ""), 1.0).report.state is GoalState.REACHED


def test_word_of_a_goal_that_its_result_overtook_is_not_another_goal() -> None:
    failed = track_result(sent(), Status("a", ABORTED, "off the map"), 1.0)
    assert track_current(failed, HERE, 1.1) == failed
    assert track_current(failed, THERE, 1.1).report.number == 2
    assert track_current(failed, HERE, 9.0).report.number == 2  # somebody sends the same goal again


def test_own_goal_coming_back_as_current_goal_is_not_another() -> None:
    assert track_current(sent(), HERE, 0.1) == sent()
    assert track_current(sent(), THERE, 0.1).report.number == 2


@pytest.mark.parametrize("status", [ACTIVE, ABORTED])
def test_goal_that_is_over_stays_over(status: int) -> None:
    done = track_result(sent(), Status("a", SUCCEEDED, ""), 1.0)
    assert track_status(done, (Status("a", status, ""),), 2.0) == done
    assert track_time(done, 100.0) == done
