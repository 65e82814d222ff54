"""Histories: what happens, and what the supervisor wants done."""

from collections.abc import Iterable
from signal import SIGINT, SIGTERM
from typing import Any

from hypothesis import given
from hypothesis import strategies as st
from tests.run.histories import CLEAN, FAILED, KILLED, MASTER, ROSOUT, RunHistory

from ur.run.supervisor.actions import (
    AwaitMaster,
    Finish,
    ReportDeath,
    ReportRevival,
    ReportStop,
    SetParameters,
    SignalUnit,
    StartUnit,
    Sweep,
    Unregister,
)
from ur.run.supervisor.events import (
    Begin,
    Event,
    Exited,
    KillNode,
    LinkLost,
    LinkRestored,
    MasterAnswered,
    MasterLost,
    MasterReplaced,
    MasterReturned,
    NothingLeft,
    ParametersSet,
    RestartNode,
    RobotMasterLost,
    SetupFailed,
    ShareFailed,
    ShareStarted,
    Started,
    StartFailed,
    StartNode,
    StopNode,
    StopRequested,
    Tick,
    Unregistered,
)
from ur.run.supervisor.state import RunPhase, TimeLimits, Unit
from ur.run.supervisor.supervisor import begin_state, next_deadline, step


def test_run_without_master_starts_it_first_and_terminal_nodes_last() -> None:
    history = RunHistory(Unit("/front", terminal=True), Unit("/a"), Unit("/b"), own_master=True)
    assert history.happens(Begin()) == [StartUnit("master"), AwaitMaster()]
    assert history.happens(Started("master", 1)) == []
    assert history.happens(MasterAnswered()) == [StartUnit("/rosout"), SetParameters()]
    assert history.happens(Started("/rosout", 2)) == []
    assert history.happens(ParametersSet()) == [StartUnit("/a"), StartUnit("/b"), StartUnit("/front")]


def test_run_with_master_starts_with_parameters() -> None:
    history = RunHistory(Unit("/a"))
    assert history.happens(Begin()) == [SetParameters()]
    assert history.happens(ParametersSet()) == [StartUnit("/a")]


def test_master_that_does_not_answer_ends_the_run() -> None:
    history = RunHistory(Unit("/a"), own_master=True)
    history.happens(Begin(), Started("master", 1))
    assert history.due() == TimeLimits().master
    told = history.happens(Tick(), after=history.due())
    assert ReportStop("the master did not answer within 15 s", failed=True) in told
    assert SignalUnit("master", SIGINT) in told
    assert StartUnit("/a") not in told


def test_master_that_dies_at_start_ends_the_run_with_1() -> None:
    history = RunHistory(Unit("/a"), own_master=True)
    history.happens(Begin(), Started("master", 1))
    told = history.happens(Exited("master", FAILED))
    assert told[0] == ReportDeath("master", FAILED, ends_run=True)
    assert history.happens(NothingLeft()) == [Finish(1)]


def test_refused_parameters_end_the_run_before_nodes_start() -> None:
    history = RunHistory(Unit("/a"))
    history.happens(Begin())
    assert history.happens(SetupFailed("no")) == [ReportStop("no", failed=True), Sweep(SIGTERM)]
    assert history.happens(NothingLeft()) == [Unregister()]
    assert history.happens(Unregistered()) == [Finish(1)]


def test_another_master_gets_the_parameters_and_every_node_starts_again() -> None:
    history = RunHistory(Unit("/a"), Unit("/b"), Unit("/c", respawn=True, respawn_delay=1.0)).running()
    history.happens(Exited("/b", FAILED), Exited("/c", FAILED))
    assert history.happens(MasterReplaced()) == [ReportRevival(), SetParameters()]
    history.happens(Tick(), after=2.0)  # nothing starts before the parameters are there
    assert history.happens(ParametersSet()) == [SignalUnit("/a", SIGINT), StartUnit("/c")]
    assert history.happens(Exited("/a", CLEAN)) == [StartUnit("/a")]


def test_master_that_goes_again_while_parameters_are_set_does_not_end_the_run() -> None:
    history = RunHistory(Unit("/a")).running()
    history.happens(MasterReplaced())
    assert history.happens(SetupFailed("gone")) == []
    assert history.state.phase is RunPhase.RUNNING
    assert history.happens(MasterReplaced()) == [ReportRevival(), SetParameters()]


_NAMES = st.sampled_from(["/a", "/b", "/front", "master", "/rosout"])
_EVENTS: st.SearchStrategy[Any] = st.one_of(
    st.just(Begin()),
    st.just(MasterAnswered()),
    st.just(ParametersSet()),
    st.just(SetupFailed("no")),
    st.builds(Started, _NAMES, st.integers(1, 9)),
    st.builds(StartFailed, _NAMES, st.just("no")),
    st.builds(Exited, _NAMES, st.sampled_from([CLEAN, FAILED, KILLED])),
    st.just(StopRequested("SIGINT")),
    st.builds(StartNode, _NAMES),
    st.builds(StopNode, _NAMES),
    st.builds(KillNode, _NAMES),
    st.builds(RestartNode, _NAMES),
    st.just(MasterLost()),
    st.just(MasterReturned()),
    st.just(MasterReplaced()),
    st.builds(RobotMasterLost, st.floats(3, 200)),
    st.builds(LinkLost, st.floats(1, 60)),
    st.builds(LinkRestored, st.floats(1, 60)),
    st.just(ShareStarted()),
    st.just(ShareFailed("no")),
    st.just(Tick()),
    st.just(NothingLeft()),
    st.just(Unregistered()),
)


@given(st.lists(st.tuples(_EVENTS, st.floats(0, 20)), max_size=40), st.booleans())
def test_any_history_followed_by_a_stop_ends_in_time(history: Iterable[tuple[Event, float]], own_master: bool) -> None:
    units = [Unit("/a", respawn=True), Unit("/b", required=True), Unit("/front", terminal=True)]
    units += [MASTER, ROSOUT] if own_master else []
    state = begin_state(units, own_master=own_master)
    now = 0.0
    alive: set[str] = set()
    finished = 0

    def follow(event: Event) -> None:
        nonlocal state, finished
        state, actions = step(state, event, now)
        for action in actions:
            if isinstance(action, StartUnit):
                assert action.name not in alive  # never two at once
                alive.add(action.name)
            finished += isinstance(action, Finish)

    for event, passed in history:
        now += passed
        if isinstance(event, (Exited, StartFailed)):
            if event.name not in alive:
                continue
            alive.discard(event.name)
        follow(event)
    follow(Begin())
    stop = now
    follow(StopRequested("SIGINT"))
    for _ in range(12):
        deadline = next_deadline(state)
        if state.phase is RunPhase.DONE or deadline is None:
            break
        now = max(now, deadline)
        follow(Tick())
    assert state.phase is RunPhase.DONE
    assert finished == 1
    assert now - stop <= 9.0  # nobody answers, not even to SIGKILL
