from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.client.patrol_text import PatrolRoute, PatrolStop
from ur_nodes.client.snapshot import LastGoalState
from ur_nodes.missions.robot.patrol import (
    LATEST,
    STALLED,
    NavigationCommands,
    Patrol,
    PatrolInputs,
    end_patrol,
    pause_patrol,
    resume_patrol,
    start_patrol,
    step_patrol,
)

SOFA, HALL = PatrolStop("sofa", 1.0, 0.0), PatrolStop("hall", 2.0, 0.0, 0.5)
ROUTE = PatrolRoute((SOFA, HALL))
DRIVES = PatrolInputs(0.0, may_drive=True, ready=True)


class PatrolMachine:
    """A patrol that is stepped ten times a second; `sent` are the goals, each with its time."""

    def __init__(self, route: PatrolRoute = ROUTE) -> None:
        self.now = 100.0
        self.patrol = start_patrol(Patrol(), route, self.now)
        self.sent: list[tuple[float, PatrolStop]] = []
        self.cancels = 0

    def step(self, seconds: float = 0.1, **inputs: object) -> str:
        for _ in range(round(seconds / 0.1)):
            self.now += 0.1
            found = replace(DRIVES, now=self.now, **inputs)  # type: ignore[arg-type] # a test's shorthand
            self.patrol, commands = step_patrol(self.patrol, found, 60.0)
            self.obey(commands)
        return self.patrol.status.state

    def obey(self, commands: NavigationCommands) -> None:
        if commands.send:
            self.sent.append((self.now, commands.send))
        self.cancels += commands.cancel


def test_patrol_waits_at_each_place_and_goes_on_though_nothing_else_happens() -> None:
    machine = PatrolMachine()
    assert machine.step() == "driving"
    assert machine.step(5.0, goal=LastGoalState.DRIVING) == "driving"
    assert machine.step(0.9, goal=LastGoalState.REACHED) == "waiting"
    assert machine.step(0.3, goal=LastGoalState.REACHED) == "driving"
    assert machine.step(1.0, goal=LastGoalState.DRIVING) == "driving"
    assert machine.step(1.2, goal=LastGoalState.REACHED) == "done"
    assert [stop for _, stop in machine.sent] == [SOFA, HALL]


def test_loop_begins_again_and_counts_its_rounds() -> None:
    machine = PatrolMachine(replace(ROUTE, loop=True, wait=0.0))
    machine.step()
    for _ in range(40):
        machine.step(0.2, goal=LastGoalState.DRIVING)
        machine.step(0.2, goal=LastGoalState.REACHED)
    assert machine.patrol.status.rounds == 20
    assert [stop.name for _, stop in machine.sent[:4]] == ["sofa", "hall", "sofa", "hall"]


@pytest.mark.parametrize("missing", [{"may_drive": False, "other": "phone"}, {"ready": False}])
def test_start_that_is_not_possible_in_time_never_happens(missing: dict[str, object]) -> None:
    machine = PatrolMachine()
    assert machine.step(LATEST - 0.2, **missing) == "starting"
    assert machine.step(0.5, **missing) == "paused"
    assert machine.step(60.0) == "paused"
    assert machine.sent == []


def test_start_that_becomes_possible_in_time_happens() -> None:
    machine = PatrolMachine()
    machine.step(4.0, may_drive=False)
    assert machine.step() == "driving"
    ((at, stop),) = machine.sent
    assert (round(at, 1), stop) == (104.1, SOFA)


def test_goal_that_navigation_does_not_take_pauses_the_patrol_and_is_cancelled() -> None:
    machine = PatrolMachine()
    assert machine.step(LATEST + 0.3) == "paused"
    assert machine.cancels == 1


def test_step_that_takes_too_long_expires() -> None:
    machine = PatrolMachine()
    assert machine.step(61.0, goal=LastGoalState.DRIVING) == "paused"
    assert machine.cancels == 1
    assert "sofa was not reached within 60 s" in machine.patrol.status.reason


def test_program_that_stood_still_starts_nothing() -> None:
    machine = PatrolMachine()
    machine.step(0.5, goal=LastGoalState.DRIVING)
    machine.step(0.3, goal=LastGoalState.REACHED)
    machine.now += 3600.0
    assert machine.step(goal=LastGoalState.REACHED) == "paused"
    assert machine.step(10.0, goal=LastGoalState.REACHED) == "paused"
    assert len(machine.sent) == 1


def test_program_that_stood_still_until_navigation_may_hold_its_goal_pauses() -> None:
    machine = PatrolMachine()
    machine.step(0.5, goal=LastGoalState.DRIVING)
    machine.now += STALLED + 0.1
    assert machine.step(0.1, goal=LastGoalState.DRIVING) == "paused"
    assert (machine.cancels, machine.patrol.status.reason) == (1, "the program stood still for 2 s")


@pytest.mark.parametrize(
    ("inputs", "reason"),
    [
        ({"stopped": True}, "emergency stop"),
        ({"may_drive": False, "other": "phone"}, "phone took over"),
        ({"goal": LastGoalState.FAILED, "text": "in a wall"}, "sofa was not reached: in a wall"),
        (
            {"goal": LastGoalState.STOPPED, "text": "a new goal has replaced this one"},
            "a new goal has replaced this one",
        ),
        ({"goal": LastGoalState.STOPPED}, "cancelled"),
    ],
)
def test_patrol_pauses_with_the_reason_and_goes_on_only_when_asked(inputs: dict[str, object], reason: str) -> None:
    machine = PatrolMachine()
    machine.step(1.0, goal=LastGoalState.DRIVING)
    assert machine.step(0.1, **inputs) == "paused"
    assert machine.patrol.status.reason == reason
    machine.step(60.0)
    assert len(machine.sent) == 1
    machine.patrol = resume_patrol(machine.patrol, machine.now)
    assert machine.step() == "driving"
    assert [stop for _, stop in machine.sent] == [SOFA, SOFA]


def test_pause_and_end_cancel_the_goal_and_nothing_is_sent_afterwards() -> None:
    for stop in (pause_patrol, end_patrol):
        machine = PatrolMachine()
        machine.step(1.0, goal=LastGoalState.DRIVING)
        machine.patrol, commands = stop(machine.patrol, "by phone", machine.now)
        assert commands.cancel
        machine.step(60.0, goal=LastGoalState.STOPPED)
        assert len(machine.sent) == 1
    assert resume_patrol(machine.patrol, machine.now) == machine.patrol  # an ended one stays ended


EVENT = st.tuples(
    st.sampled_from(["start", "pause", "resume", "end", "step"]),
    st.floats(0.0, 20.0),
    st.booleans(),
    st.booleans(),
    st.booleans(),
    st.sampled_from([None, *LastGoalState]),
)


@given(st.lists(EVENT, max_size=60), st.booleans())
def test_no_goal_is_sent_but_in_time_after_a_request_or_as_the_next_of_a_patrol_that_is_active(
    events: list[tuple[str, float, bool, bool, bool, LastGoalState | None]], loop: bool
) -> None:
    now, asked, patrol = 0.0, float("-inf"), Patrol()
    for kind, pause, may_drive, ready, stopped, goal in events:
        now += pause
        before = patrol.status
        commands = NavigationCommands()
        if kind == "start":
            patrol, asked = start_patrol(patrol, replace(ROUTE, loop=loop), now), now
        elif kind == "pause":
            patrol, commands = pause_patrol(patrol, "", now)
        elif kind == "end":
            patrol, commands = end_patrol(patrol, "", now)
        elif kind == "resume":
            asked = now if patrol.status.state == "paused" else asked
            patrol = resume_patrol(patrol, now)
        else:
            inputs = PatrolInputs(now, may_drive, ready, stopped=stopped, goal=goal)
            patrol, commands = step_patrol(patrol, inputs, 60.0)
        if commands.send:
            assert may_drive
            assert ready
            assert not stopped
            assert now - asked <= LATEST or before.state == "waiting" or before.index + before.rounds
            assert before.active
