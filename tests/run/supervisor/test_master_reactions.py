from ur.run.supervisor.actions import Action, ReportLink, ReportRevival, ReportStop, SetParameters, StartShare
from ur.run.supervisor.events import (
    Begin,
    Event,
    LinkLost,
    LinkRestored,
    MasterReplaced,
    ParametersSet,
    RobotMasterLost,
    SetupFailed,
    ShareFailed,
    ShareStarted,
    Started,
)
from ur.run.supervisor.state import State, Unit
from ur.run.supervisor.supervisor import begin_state, step


def run_state(*, shared: bool) -> State:
    """A run of one node on somebody else's master."""
    state = begin_state([Unit("/a")], own_master=False, shared=shared)
    for event in (Begin(), ParametersSet(), Started("/a", 7)):
        state, _ = step(state, event, 0.0)
    return state


def follow(state: State, *events: Event) -> tuple[State, list[Action]]:
    actions: list[Action] = []
    for event in events:
        state, more = step(state, event, 1.0)
        actions += more
    return state, actions


def test_lost_link_is_told_and_changes_nothing() -> None:
    before = run_state(shared=True)
    state, actions = follow(before, LinkLost(1.2), LinkRestored(12.3))
    assert actions == [ReportLink(lost=True, seconds=1.2), ReportLink(lost=False, seconds=12.3)]
    assert state == before


def test_robot_starts_its_share_again_before_nodes_here_do() -> None:
    state, actions = follow(run_state(shared=True), MasterReplaced())
    assert actions == [ReportRevival(), StartShare()]
    state, actions = follow(state, MasterReplaced(), RobotMasterLost(4.0))  # seen while it starts
    assert actions == []
    state, actions = follow(state, ShareStarted())
    assert actions == [SetParameters()]
    state, actions = follow(state, ParametersSet())
    assert not state.reviving
    assert [type(each).__name__ for each in actions] == ["SignalUnit"]


def test_robot_without_a_master_is_asked_to_start_its_share() -> None:
    _, actions = follow(run_state(shared=True), RobotMasterLost(3.0))
    assert actions == [ReportRevival(), StartShare()]


def test_run_ends_with_1_when_the_robot_cannot_start_its_share() -> None:
    state, actions = follow(run_state(shared=True), RobotMasterLost(3.0), ShareFailed("bob: its nodes are gone"))
    assert ReportStop("bob: its nodes are gone", failed=True) in actions
    assert state.exit_code == 1


def test_run_does_not_wait_for_ever_for_the_master_of_a_robot_that_answers() -> None:
    state, actions = follow(run_state(shared=False), RobotMasterLost(3.0), RobotMasterLost(60.0))
    assert actions == []
    state, actions = follow(state, RobotMasterLost(120.0))
    cause = "the robot answers, but no ROS master has run on it for 120 s"
    assert ReportStop(cause, failed=True) in actions
    assert state.exit_code == 1


def test_parameters_that_a_cut_kept_from_the_new_master_are_set_after_it() -> None:
    state, _ = follow(run_state(shared=False), MasterReplaced(), SetupFailed("no answer"))
    state, actions = follow(state, LinkLost(5.0), LinkRestored(9.0))
    assert actions[-2:] == [ReportRevival(), SetParameters()]
    state, actions = follow(state, ParametersSet(), LinkRestored(2.0))
    assert actions[-1] == ReportLink(lost=False, seconds=2.0)  # once
