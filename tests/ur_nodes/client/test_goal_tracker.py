from typing import Final, Literal

import pytest

from ur_nodes.client.goal_tracker import (
    ANSWER_LIMIT,
    SILENCE,
    GoalTracker,
    read_hold,
    report_at,
    track_current,
    track_hold,
    track_result,
    track_sent,
    track_status,
)
from ur_nodes.client.snapshot import GoalReport, LastGoalState
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports import actions

HERE, THERE = Pose2(1.0, 2.0, 0.0), Pose2(5.0, 6.0, 0.0)
ACTIVE: Final = "active"
CANCELLED: Final = "cancelled"
SUCCEEDED: Final = "succeeded"
ABORTED: Final = "aborted"


def sent() -> GoalTracker:
    return track_sent(GoalTracker(), "a", HERE, 0.0)


def test_goal_goes_from_sent_over_driving_to_reached() -> None:
    tracker = sent()
    assert tracker.report.state is LastGoalState.WAITING
    tracker = track_status(tracker, (actions.GoalState("a", ACTIVE, ""),), 0.1)
    assert tracker.report.state is LastGoalState.DRIVING
    tracker = track_result(tracker, actions.GoalState("a", SUCCEEDED, "Goal reached."), 9.0)
    assert (tracker.report.state, tracker.report.over) == (LastGoalState.REACHED, True)


def test_failure_passes_on_the_reason() -> None:
    report = track_result(sent(), actions.GoalState("a", ABORTED, "the goal is in a wall"), 1.0).report
    assert (report.state, report.text) == (LastGoalState.FAILED, "the goal is in a wall")
    assert track_result(sent(), actions.GoalState("a", ABORTED, ""), 1.0).report.text == "move_base gave no reason"


def test_reason_cannot_steer_a_terminal() -> None:
    report = track_result(sent(), actions.GoalState("a", ABORTED, "no\x1b[2J \n way" + "!" * 1000), 1.0).report
    assert report.text.startswith("no [2J way!!")
    assert len(report.text) <= 500


def test_result_that_got_lost_is_seen_in_the_status_list() -> None:
    assert track_status(sent(), (actions.GoalState("a", CANCELLED, ""),), 1.0).report.state is LastGoalState.STOPPED


def test_goal_that_was_over_before_this_client_came_is_forgotten() -> None:
    tracker = track_current(GoalTracker(), HERE, 0.0)
    assert report_at(tracker, 0.1) == GoalReport(1)
    tracker = track_status(tracker, (actions.GoalState("a", ABORTED, "no way"),), 0.5)
    assert report_at(tracker, 0.6) == GoalReport(1)
    tracker = track_status(tracker, (actions.GoalState("a", SUCCEEDED, ""),), 1.2)
    assert (tracker.report.state, tracker.report.pose) == (LastGoalState.NONE, None)


def test_what_happens_to_other_goals_changes_nothing() -> None:
    assert track_result(sent(), actions.GoalState("b", ABORTED, "no"), 1.0) == sent()
    assert track_status(sent(), (actions.GoalState("b", ACTIVE, ""),), 1.0).report == sent().report


def test_new_goal_has_the_next_number_and_ignores_the_old_result() -> None:
    tracker = track_sent(sent(), "b", THERE, 1.0)
    assert tracker.report.number == 2
    assert track_result(tracker, actions.GoalState("a", CANCELLED, ""), 1.1).report.state is LastGoalState.WAITING


def listed(tracker: GoalTracker, until: float, since: float, *statuses: actions.GoalState) -> GoalTracker:
    """Status lists five times a second."""
    for tick in range(round(since * 5), round(until * 5) + 1):
        tracker = track_status(tracker, statuses, tick / 5)
    return tracker


def test_goal_that_a_restarted_move_base_does_not_know_fails() -> None:
    tracker = listed(sent(), 1.0, 0.2, actions.GoalState("a", ACTIVE, ""))
    tracker = listed(tracker, 1.0 + ANSWER_LIMIT, 1.2)
    assert tracker.report.state is LastGoalState.DRIVING
    tracker = listed(tracker, 1.6 + ANSWER_LIMIT, 1.2 + ANSWER_LIMIT)
    assert tracker.report.state is LastGoalState.FAILED
    assert "restarted" in tracker.report.text


def test_goal_that_never_arrived_fails() -> None:
    tracker = listed(sent(), 0.6 + ANSWER_LIMIT, 0.2)
    assert (tracker.report.state, tracker.report.text) == (
        LastGoalState.FAILED,
        "the goal did not reach move_base; send it again",
    )


def test_silence_leaves_the_goal_open_and_unknown() -> None:
    tracker = listed(sent(), 1.0, 0.2, actions.GoalState("a", ACTIVE, ""))
    assert report_at(tracker, 1.0 + SILENCE).state is LastGoalState.DRIVING
    for silent in (1.1, 10.0, 1000.0):
        report = report_at(tracker, 1.0 + silent)
        assert (report.state, report.over) == (LastGoalState.UNKNOWN, False)
    tracker = track_status(tracker, (actions.GoalState("a", ACTIVE, ""),), 2000.0)
    assert report_at(tracker, 2000.1).state is LastGoalState.DRIVING


def test_goal_that_is_not_in_the_first_lists_after_a_silence_has_not_failed_yet() -> None:
    tracker = listed(sent(), 14.0, 10.0)
    assert report_at(tracker, 14.1).state is LastGoalState.WAITING
    assert track_status(tracker, (actions.GoalState("a", ACTIVE, ""),), 14.2).report.state is LastGoalState.DRIVING


def test_goal_that_ended_during_a_silence_says_how_when_the_list_is_back() -> None:
    tracker = listed(sent(), 1.0, 0.2, actions.GoalState("a", ACTIVE, ""))
    tracker = track_status(tracker, (actions.GoalState("a", SUCCEEDED, "goal reached"),), 100.0)
    assert report_at(tracker, 200.0).state is LastGoalState.REACHED
    taken = track_status(sent(), (actions.GoalState("a", CANCELLED, "laptop2 took over"),), 100.0)
    assert (taken.report.state, taken.report.text) == (LastGoalState.STOPPED, "laptop2 took over")


def test_goal_that_move_base_holds_is_held_with_its_reason() -> None:
    text = "held: no word from laptop for 3 s"
    tracker = track_hold(track_status(sent(), (actions.GoalState("a", ACTIVE, text),), 0.2), "a")
    assert report_at(tracker, 0.3) == GoalReport(1, HERE, LastGoalState.HELD, text)
    assert report_at(track_hold(tracker, "other"), 0.3).state is LastGoalState.DRIVING
    assert report_at(tracker, 2.0).state is LastGoalState.UNKNOWN


@pytest.mark.parametrize(
    ("text", "hold"),
    [
        ('{"goal": "a", "state": "held", "text": "x"}', "a"),
        ('{"goal": "", "state": ""}', ""),
        ('{"goal": 1, "state": "held"}', None),
        ('{"goal": "a", "state": []}', None),
        ("[]", None),
        ("", None),
        ("[" * 4000, None),
        (" " * 5000 + "{}", None),
    ],
)
def test_word_of_a_hold_is_read_and_checked(text: str, hold: str | None) -> None:
    assert read_hold(text) == hold


def test_goal_from_elsewhere_is_followed() -> None:
    tracker = track_current(GoalTracker(), THERE, 0.0)
    tracker = track_status(
        tracker, (actions.GoalState("old", SUCCEEDED, ""), actions.GoalState("rviz", ACTIVE, "")), 0.2
    )
    assert report_at(tracker, 0.3) == GoalReport(1, THERE, LastGoalState.DRIVING)
    assert tracker.goal_id == "rviz"
    assert track_result(tracker, actions.GoalState("rviz", SUCCEEDED, ""), 1.0).report.state is LastGoalState.REACHED


def test_goal_from_elsewhere_that_is_refused_at_once_is_reported() -> None:
    tracker = track_result(
        track_current(GoalTracker(), THERE, 0.0), actions.GoalState("rviz", ABORTED, "in a wall"), 0.1
    )
    assert report_at(tracker, 0.2) == GoalReport(1, THERE, LastGoalState.FAILED, "in a wall")


def test_word_of_a_goal_that_its_result_overtook_is_not_another_goal() -> None:
    failed = track_result(sent(), actions.GoalState("a", ABORTED, "off the map"), 1.0)
    assert track_current(failed, HERE, 1.1) == failed
    assert track_current(failed, THERE, 1.1).report.number == 2
    assert track_current(failed, HERE, 9.0).report.number == 2  # somebody sends the same goal again


def test_own_goal_coming_back_as_current_goal_is_not_another() -> None:
    assert track_current(sent(), HERE, 0.1) == sent()
    assert track_current(sent(), THERE, 0.1).report.number == 2


def test_late_messages_about_a_replaced_goal_of_this_client_do_not_end_the_new_one() -> None:
    tracker = track_sent(sent(), "b", THERE, 0.1)
    for place in (HERE, THERE):  # move_base reports both, in this order, after the second was sent
        tracker = track_current(tracker, place, 0.2)
    tracker = track_status(tracker, (actions.GoalState("a", ACTIVE, ""),), 0.3)
    tracker = track_result(tracker, actions.GoalState("a", CANCELLED, "a new goal has replaced this one"), 0.4)
    assert (tracker.goal_id, tracker.report) == ("b", GoalReport(2, THERE, LastGoalState.WAITING))
    assert track_current(tracker, HERE, 0.5).report.number == 3  # another client sends it there


def test_late_messages_about_a_goal_that_another_client_replaced_do_not_end_the_new_one() -> None:
    tracker = track_current(sent(), THERE, 0.1)
    tracker = track_status(tracker, (actions.GoalState("a", ACTIVE, ""),), 0.2)
    tracker = track_result(tracker, actions.GoalState("a", CANCELLED, "a new goal has replaced this one"), 0.3)
    assert (tracker.goal_id, tracker.report) == ("", GoalReport(2, THERE, LastGoalState.DRIVING))
    tracker = track_status(tracker, (actions.GoalState("a", CANCELLED, ""), actions.GoalState("rviz", ACTIVE, "")), 0.4)
    assert tracker.goal_id == "rviz"


@pytest.mark.parametrize("status", [ACTIVE, ABORTED])
def test_goal_that_is_over_stays_over(status: Literal["active", "aborted"]) -> None:
    done = track_result(sent(), actions.GoalState("a", SUCCEEDED, ""), 1.0)
    assert track_status(done, (actions.GoalState("a", status, ""),), 2.0) == done
    assert report_at(done, 100.0) == done.report
