from dataclasses import dataclass, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.motion.lease.text import FREE, Lease
from ur_nodes.navigation.goals.attendance import (
    Act,
    Attendance,
    AttendanceSettings,
    GoalVerdict,
    attend_goal,
    clock_time,
    refuse_goal,
    step_attendance,
)
from ur_nodes.navigation.goals.goal_claim import Claim, ReceivedChallenges, note_challenge

SECOND = 1_000_000_000
HELD = Lease("held", "aa", "laptop", since=50.0)
LOST = replace(HELD, state="lost")
OTHER = Lease("held", "bb", "laptop2", since=60.0)
MINE = Claim("aa", SECOND)
SETTINGS = AttendanceSettings(grace=3.0)


@dataclass
class Goal:
    """A goal under observation: `at` steps it."""

    attendance: Attendance
    settings: AttendanceSettings = SETTINGS

    def at(self, now: float, lease: Lease | None, silence: float | None = 0.0) -> GoalVerdict:
        self.attendance, verdict = step_attendance(self.attendance, lease, silence, self.settings, now)
        return verdict


def attend(claim: Claim | None) -> Attendance:
    """The attendance of a goal of unknown age."""
    return attend_goal(claim, ReceivedChallenges(), 0.0)


def test_goal_of_the_driver_is_held_as_soon_as_the_mux_has_lost_the_driver_and_goes_on_when_back() -> None:
    goal = Goal(attend(MINE))
    assert goal.at(0.0, HELD) == GoalVerdict(Act.DRIVE)
    assert goal.at(1.0, LOST) == GoalVerdict(Act.HOLD, "held: no word from laptop for 3 s")
    assert goal.at(8.0, LOST).text == "held: no word from laptop for 10 s"
    assert goal.at(8.1, HELD) == GoalVerdict(Act.DRIVE)


@pytest.mark.parametrize("before", [HELD, LOST, FREE])
@pytest.mark.parametrize("claim", [MINE, None])
def test_goal_is_cancelled_when_another_client_takes_over(before: Lease, claim: Claim | None) -> None:
    goal = Goal(attend(claim))
    goal.at(0.0, HELD)
    goal.at(0.1, before)
    expected = Act.DRIVE if before is FREE and claim is None else Act.CANCEL
    verdict = goal.at(0.2, OTHER)
    assert verdict.act is expected
    assert verdict.text == ("laptop2 took over" if expected is Act.CANCEL else "")


def test_goal_that_was_sent_unattended_goes_on() -> None:
    goal = Goal(attend(MINE))
    goal.at(0.0, replace(HELD, attended=False))
    assert goal.at(1.0, replace(LOST, attended=False)).act is Act.DRIVE
    assert goal.at(100.0, FREE).act is Act.DRIVE


@pytest.mark.parametrize("lease", [None, FREE])
def test_goal_of_a_script_drives_while_nobody_holds_the_lease(lease: Lease | None) -> None:
    goal = Goal(attend(None))
    for now in range(0, 1000, 7):
        assert goal.at(float(now), lease, None if lease is None else 0.0) == GoalVerdict(Act.DRIVE)
    assert goal.attendance.unattended


def test_goal_of_a_script_belongs_to_who_drives_and_is_nobodys_again_after_the_release() -> None:
    goal = Goal(attend(None))
    goal.at(0.0, HELD)
    assert goal.at(1.0, LOST).act is Act.HOLD
    assert goal.at(2.0, HELD).act is Act.DRIVE
    assert goal.at(3.0, FREE).act is Act.DRIVE
    assert goal.at(30.0, FREE).act is Act.DRIVE


def test_goal_of_a_client_that_is_back_x_the_lease_says_so_and_asks_nothing() -> None:
    goal = Goal(attend(MINE))
    assert goal.at(0.0, LOST).act is Act.DRIVE
    assert goal.at(0.2, HELD).act is Act.DRIVE
    assert goal.at(0.4, LOST).act is Act.HOLD
    lone = Goal(attend(MINE))
    lone.at(0.0, LOST)
    assert lone.at(3.1, LOST).act is Act.HOLD


def test_goal_of_a_script_that_comes_while_the_driver_is_lost_is_not_held_until_the_driver_was_back() -> None:
    goal = Goal(attend(None))
    assert goal.at(0.0, LOST).act is Act.DRIVE
    assert goal.attendance.unattended
    assert goal.at(1.0, HELD).act is Act.DRIVE
    assert goal.at(2.0, LOST).act is Act.HOLD


def test_held_goal_does_not_go_on_because_the_mux_was_restarted() -> None:
    goal = Goal(attend(None))
    goal.at(0.0, HELD)
    goal.at(1.0, LOST)
    assert goal.at(2.0, FREE).act is Act.HOLD
    assert goal.at(3.0, HELD).act is Act.DRIVE


def test_goal_survives_a_short_restart_of_the_mux() -> None:
    goal = Goal(attend(MINE))
    goal.at(0.0, HELD)
    assert goal.at(0.1, FREE).act is Act.DRIVE
    assert goal.at(2.0, HELD).act is Act.DRIVE
    assert goal.at(3.0, FREE).act is Act.DRIVE
    assert goal.at(6.1, FREE) == GoalVerdict(Act.HOLD, "held: no word from laptop for 3 s")


def test_goal_that_overtook_the_lease_of_its_sender_is_driven_and_held_without_one() -> None:
    goal = Goal(attend(Claim("bb", SECOND)))
    assert goal.at(0.0, LOST).act is Act.DRIVE
    assert goal.at(0.2, OTHER).act is Act.DRIVE
    late = Goal(attend(Claim("cc", SECOND)))
    assert late.at(0.0, FREE).act is Act.DRIVE
    assert late.at(3.1, FREE).text == "held: no word from the program that sent the goal for 3 s"


@pytest.mark.parametrize("claim", [MINE, None])
def test_goal_is_held_while_the_mux_is_silent(claim: Claim | None) -> None:
    goal = Goal(attend(claim))
    goal.at(0.0, HELD)
    assert goal.at(2.0, HELD, 2.0).act is Act.DRIVE
    assert goal.at(4.0, HELD, 4.0) == GoalVerdict(Act.HOLD, "held: no word from the mux for 4 s")
    assert goal.at(5.0, HELD, 0.1).act is Act.DRIVE


def test_held_goal_is_cancelled_after_the_limit_unless_there_is_none() -> None:
    goal, patient = (Goal(attend(MINE), AttendanceSettings(limit=limit)) for limit in (60.0, 0.0))
    for each in (goal, patient):
        each.at(-1.0, HELD)
        each.at(0.0, LOST)
        assert each.at(59.0, LOST).act is Act.HOLD
    assert goal.at(60.5, LOST) == GoalVerdict(Act.CANCEL, "held for 60 s: no word from laptop")
    assert patient.at(1e6, LOST).act is Act.HOLD


def challenges(*arrivals: tuple[float, float]) -> ReceivedChallenges:
    made = ReceivedChallenges()
    for value, at in arrivals:
        made = note_challenge(made, round(value * SECOND), at)
    return made


def test_late_goal_is_refused_with_its_age() -> None:
    heard = challenges((1.0, 10.0), (4.1, 13.1))
    assert refuse_goal(MINE, HELD, heard, 13.2) == "the goal arrived late (3.2 s), send it again"
    assert refuse_goal(MINE, HELD, challenges((1.0, 10.0)), 10.9) == ""
    assert refuse_goal(MINE, HELD, challenges((1.0, 10.0)), 11.1).startswith("the goal arrived late (1.1 s)")
    assert refuse_goal(MINE, HELD, ReceivedChallenges(), 0.0) == "the goal arrived late, send it again"


def test_goal_of_a_client_that_does_not_drive_is_refused_while_another_does() -> None:
    heard = challenges((1.0, 10.0))
    assert refuse_goal(MINE, OTHER, heard, 10.1) == f"laptop2 drives since {clock_time(60.0)}"
    lost = replace(OTHER, state="lost", until=120.0)
    expected = f"laptop2 drove until {clock_time(120.0)} and is out of reach, take over first"
    assert refuse_goal(MINE, lost, heard, 10.1) == expected
    for lease in (None, FREE, HELD, LOST):
        assert refuse_goal(MINE, lease, heard, 10.1) == ""
    assert refuse_goal(None, OTHER, heard, 99.0) == ""


LEASES = st.one_of(
    st.just(FREE),
    st.builds(Lease, st.sampled_from(["held", "lost"]), st.sampled_from(["aa", "bb"]), attended=st.booleans()),
)
STEPS = st.lists(st.tuples(st.floats(0.0, 5.0), LEASES, st.floats(0.0, 6.0)), max_size=40)


@given(st.sampled_from([MINE, None]), STEPS)
def test_robot_drives_only_while_nothing_forbids_it(
    claim: Claim | None, steps: list[tuple[float, Lease, float]]
) -> None:
    settings = AttendanceSettings()
    attendance, now, absent_since = attend(claim), 0.0, None
    for gap, lease, silence in steps:
        now += gap
        before = attendance
        attendance, verdict = step_attendance(attendance, lease, silence, settings, now)
        owner = attendance.client
        other = lease.state == "held" and lease.client != before.client and bool(before.client)
        assert (verdict.act is Act.CANCEL and verdict.text.endswith("took over")) == other
        if verdict.act is Act.CANCEL:
            return
        away = bool(owner) and attendance.attended and (lease.client != owner or lease.state == "lost")
        absent_since = (now if absent_since is None else absent_since) if away else None
        if verdict.act is Act.DRIVE:
            assert silence < settings.grace
            proven = attendance.claimed and not attendance.present  # by the answer in the goal's id, a moment ago
            assert proven or not (lease.state == "lost" and lease.client == owner and lease.attended)
            assert absent_since is None or now - absent_since < settings.grace
        else:
            assert verdict.text
