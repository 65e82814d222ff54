"""Histories: what happens, and what the supervisor wants done. No process anywhere."""

from __future__ import annotations

from collections.abc import Iterable
from signal import SIGINT, SIGKILL, SIGTERM
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.run.actions import (
    Action,
    AwaitMaster,
    Finish,
    SetParameters,
    Signal,
    Start,
    Sweep,
    TellDeath,
    TellPressure,
    TellRevival,
    TellStop,
    TellWish,
    Unregister,
)
from ur.run.happenings import (
    Begin,
    Event,
    Exited,
    MasterAnswered,
    MasterLost,
    MasterReplaced,
    MasterReturned,
    NothingLeft,
    ParametersSet,
    RestartWanted,
    SetupFailed,
    Started,
    StartFailed,
    StartWanted,
    StopRequested,
    StopWanted,
    Tick,
    Unregistered,
)
from ur.run.model import ExitStatus, Limits, Phase, State, Unit
from ur.run.supervisor import begin_state, next_deadline, step

CLEAN = ExitStatus(code=0)
FAILED = ExitStatus(code=3)
KILLED = ExitStatus(signal=9)
MASTER = Unit("master", core=True, required=True)
ROSOUT = Unit("/rosout", core=True, respawn=True)


class History:
    """A run that is being told what happens."""

    def __init__(self, *units: Unit, own_master: bool = False) -> None:
        core = (MASTER, ROSOUT) if own_master else ()
        self.state: State = begin_state([*units, *core], own_master=own_master)
        self.now = 100.0

    def happens(self, *events: Event, after: float = 0.0) -> list[Action]:
        self.now += after
        told: list[Action] = []
        for event in events:
            self.state, actions = step(self.state, event, self.now)
            told += actions
        return told

    def running(self) -> History:
        """Everything is up."""
        if self.state.own_master:
            self.happens(Begin(), Started("master", 1), MasterAnswered(), Started("/rosout", 2), ParametersSet())
        else:
            self.happens(Begin(), ParametersSet())
        for number, each in enumerate(self.state.units, 10):
            self.happens(Started(each.unit.name, number))
        return self

    def due(self) -> float:
        deadline = next_deadline(self.state)
        assert deadline is not None
        return deadline - self.now


def test_run_without_master_starts_it_first_and_terminal_nodes_last() -> None:
    history = History(Unit("/front", terminal=True), Unit("/a"), Unit("/b"), own_master=True)
    assert history.happens(Begin()) == [Start("master"), AwaitMaster()]
    assert history.happens(Started("master", 1)) == []
    assert history.happens(MasterAnswered()) == [Start("/rosout"), SetParameters()]
    assert history.happens(Started("/rosout", 2)) == []
    assert history.happens(ParametersSet()) == [Start("/a"), Start("/b"), Start("/front")]


def test_run_with_master_starts_with_parameters() -> None:
    history = History(Unit("/a"))
    assert history.happens(Begin()) == [SetParameters()]
    assert history.happens(ParametersSet()) == [Start("/a")]


def test_master_that_does_not_answer_ends_the_run() -> None:
    history = History(Unit("/a"), own_master=True)
    history.happens(Begin(), Started("master", 1))
    assert history.due() == Limits().master
    told = history.happens(Tick(), after=history.due())
    assert TellStop("the master did not answer within 15 s", failed=True) in told
    assert Signal("master", SIGINT) in told
    assert Start("/a") not in told


def test_master_that_dies_at_start_ends_the_run_with_1() -> None:
    history = History(Unit("/a"), own_master=True)
    history.happens(Begin(), Started("master", 1))
    told = history.happens(Exited("master", FAILED))
    assert told[0] == TellDeath("master", FAILED, ends_run=True)
    assert history.happens(NothingLeft()) == [Finish(1)]


def test_refused_parameters_end_the_run_before_nodes_start() -> None:
    history = History(Unit("/a"))
    history.happens(Begin())
    assert history.happens(SetupFailed("no")) == [TellStop("no", failed=True), Sweep(SIGTERM)]
    assert history.happens(NothingLeft()) == [Unregister()]
    assert history.happens(Unregistered()) == [Finish(1)]


def test_stop_interrupts_all_nodes_at_once_then_rosout_then_master() -> None:
    history = History(Unit("/a"), Unit("/b"), own_master=True).running()
    assert history.happens(StopRequested("SIGINT")) == [
        TellStop("SIGINT"),
        Signal("/a", SIGINT),
        Signal("/b", SIGINT),
    ]
    assert history.happens(Exited("/a", KILLED)) == []
    assert history.happens(Exited("/b", CLEAN)) == [Signal("/rosout", SIGINT)]
    assert history.happens(Exited("/rosout", CLEAN)) == [Signal("master", SIGINT)]
    assert history.happens(Exited("master", CLEAN)) == [Sweep(SIGTERM)]
    assert history.happens(NothingLeft()) == [Finish(0)]
    assert history.state.phase is Phase.DONE


def test_stubborn_nodes_get_stronger_signals_within_5_seconds() -> None:
    history = History(Unit("/a"), Unit("/b"), own_master=True).running()
    begin = history.now
    history.happens(StopRequested("SIGINT"), Exited("/b", CLEAN))
    assert history.happens(Tick(), after=history.due()) == [TellPressure(("/a",), SIGTERM), Signal("/a", SIGTERM)]
    assert history.happens(Tick(), after=history.due()) == [TellPressure(("/a",), SIGKILL), Signal("/a", SIGKILL)]
    assert history.happens(Exited("/a", KILLED)) == [Signal("/rosout", SIGINT)]
    assert history.happens(Tick(), after=history.due()) == [Signal("master", SIGKILL), Signal("/rosout", SIGKILL)]
    history.happens(Exited("master", KILLED), Exited("/rosout", KILLED))
    assert history.happens(Tick(), after=history.due()) == [Sweep(SIGKILL)]
    assert history.happens(NothingLeft()) == [Finish(0)]
    assert history.now - begin < 5.0


def test_asking_again_to_stop_is_faster() -> None:
    history = History(Unit("/a")).running()
    history.happens(StopRequested("SIGINT"))
    assert Signal("/a", SIGTERM) in history.happens(StopRequested("SIGINT"))
    assert Signal("/a", SIGKILL) in history.happens(StopRequested("SIGINT"))


def test_process_that_hangs_in_the_kernel_does_not_hang_the_run() -> None:
    history = History(Unit("/a")).running()
    history.happens(StopRequested("SIGINT"))
    for _ in range(20):
        if history.state.phase is Phase.DONE:
            break
        history.happens(Tick(), after=history.due())
    assert history.state.phase is Phase.DONE


def test_stop_before_a_process_is_there_reaches_it_later() -> None:
    history = History(Unit("/a"))
    history.happens(Begin(), ParametersSet(), StopRequested("SIGINT"))
    assert history.happens(Started("/a", 1)) == [Signal("/a", SIGINT)]


def test_required_node_that_fails_ends_the_run_as_roslaunch_with_0() -> None:
    history = History(Unit("/a", required=True), Unit("/b")).running()
    assert history.happens(Exited("/a", FAILED)) == [
        TellDeath("/a", FAILED, ends_run=True),
        TellStop("/a is required and has ended"),
        Signal("/b", SIGINT),
    ]
    history.happens(Exited("/b", CLEAN), NothingLeft())
    assert history.happens(Unregistered()) == [Finish(0)]


@pytest.mark.parametrize(
    ("status", "code", "told"), [(CLEAN, 0, False), (FAILED, 3, False), (KILLED, 137, True), (ExitStatus(), 127, True)]
)
def test_terminal_node_ends_the_run_with_its_exit_code(status: ExitStatus, code: int, told: bool) -> None:
    history = History(Unit("/front", terminal=True, required=True)).running()
    actions = history.happens(Exited("/front", status))
    assert any(isinstance(action, TellDeath) for action in actions) is told
    history.happens(NothingLeft())
    assert history.happens(Unregistered()) == [Finish(code)]


def test_run_ends_when_every_node_has_ended() -> None:
    history = History(Unit("/a"), Unit("/b"), own_master=True).running()
    assert history.happens(Exited("/a", CLEAN)) == [TellDeath("/a", CLEAN)]
    assert history.happens(Exited("/b", FAILED)) == [
        TellDeath("/b", FAILED),
        TellStop("every node has ended"),
        Signal("/rosout", SIGINT),
    ]


def test_run_that_started_nothing_ends_with_1() -> None:
    history = History(Unit("/a"))
    history.happens(Begin(), ParametersSet())
    told = history.happens(StartFailed("/a", "no such file"))
    assert told[0] == TellDeath("/a", ExitStatus(), "no such file")
    history.happens(NothingLeft())
    assert history.happens(Unregistered()) == [Finish(1)]


def test_master_without_nodes_runs_until_asked_to_stop() -> None:
    history = History(own_master=True).running()
    assert next_deadline(history.state) is None
    assert history.happens(StopRequested("SIGINT"))[-1] == Signal("/rosout", SIGINT)


def test_respawn_waits_its_delay_and_node_that_keeps_dying_comes_ever_later() -> None:
    history = History(Unit("/a", respawn=True, respawn_delay=0.5), Unit("/b")).running()
    delays = []
    for _ in range(9):
        [death] = history.happens(Exited("/a", FAILED), after=0.1)
        assert isinstance(death, TellDeath)
        delays.append(death.restart_in)
        assert history.happens(Tick(), after=history.due() - 0.01) == []
        assert history.happens(Tick(), after=0.02) == [Start("/a")]
        history.happens(Started("/a", 5))
    assert delays == [0.5, 0.5, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 30.0]
    [death] = history.happens(Exited("/a", FAILED), after=Limits().quick_death)
    assert isinstance(death, TellDeath)
    assert death.restart_in == 0.5


def test_node_waiting_for_its_respawn_does_not_hold_the_stop_up() -> None:
    history = History(Unit("/a", respawn=True, respawn_delay=60.0)).running()
    history.happens(Exited("/a", FAILED))
    assert history.happens(StopRequested("SIGINT")) == [TellStop("SIGINT"), Sweep(SIGTERM)]


def test_late_news_about_unknown_or_ended_units_change_nothing() -> None:
    history = History(Unit("/a"), Unit("/b")).running()
    history.happens(Exited("/a", CLEAN))
    before = history.state
    assert history.happens(Exited("/a", FAILED), Exited("/nobody", CLEAN), Started("/a", 9), MasterAnswered()) == []
    assert history.state == before


def test_storm_of_deaths_ends_with_giving_up_and_a_restart_by_hand_begins_anew() -> None:
    history = History(Unit("/a", respawn=True), Unit("/b")).running()
    for _ in range(Limits().quick_deaths - 1):
        history.happens(Exited("/a", FAILED), after=0.1)
        history.happens(Tick(), after=history.due())
        history.happens(Started("/a", 5))
    assert history.happens(Exited("/a", FAILED)) == [TellDeath("/a", FAILED, deaths=Limits().quick_deaths)]
    assert next_deadline(history.state) is None
    assert history.happens(RestartWanted("/a")) == [Start("/a")]
    history.happens(Started("/a", 6))
    [death] = history.happens(Exited("/a", FAILED))
    assert isinstance(death, TellDeath)
    assert death.restart_in == 0.0


def test_node_that_refuses_its_input_is_given_up_sooner_and_ends_the_run_with_1() -> None:
    history = History(Unit("/a", respawn=True)).running()
    refused = ExitStatus(code=2)
    for _ in range(2):
        history.happens(Exited("/a", refused))
        history.happens(Tick(), after=history.due())
        history.happens(Started("/a", 5))
    told = history.happens(Exited("/a", refused))
    assert told[:2] == [TellDeath("/a", refused, deaths=3), TellStop("every node has ended")]
    history.happens(NothingLeft())
    assert history.happens(Unregistered()) == [Finish(1)]


def test_no_limit_respawns_for_ever() -> None:
    history = History(Unit("/a", respawn=True))
    history.state = begin_state([Unit("/a", respawn=True)], own_master=False, limits=Limits(quick_deaths=0))
    history.running()
    for _ in range(40):
        history.happens(Exited("/a", FAILED))
        assert history.happens(Tick(), after=history.due()) == [Start("/a")]
        history.happens(Started("/a", 5))


def test_node_stopped_by_hand_stays_stopped_and_keeps_the_run() -> None:
    history = History(Unit("/a", respawn=True), Unit("/b", required=True)).running()
    for name in ("/a", "/b"):
        assert history.happens(StopWanted(name)) == [Signal(name, SIGINT)]
        assert history.happens(Exited(name, FAILED)) == [TellWish(name)]
    assert history.state.phase is Phase.RUNNING
    assert next_deadline(history.state) is None
    assert history.happens(StartWanted("/a")) == [Start("/a")]


def test_stubborn_node_stopped_by_hand_gets_stronger_signals() -> None:
    history = History(Unit("/a"), Unit("/b")).running()
    history.happens(StopWanted("/a"))
    assert history.happens(Tick(), after=history.due()) == [TellPressure(("/a",), SIGTERM), Signal("/a", SIGTERM)]
    assert history.happens(Tick(), after=history.due()) == [TellPressure(("/a",), SIGKILL), Signal("/a", SIGKILL)]
    history.happens(Tick(), after=history.due())
    assert next_deadline(history.state) is None
    assert history.happens(Exited("/a", KILLED)) == [TellWish("/a")]


def test_restart_by_hand_waits_for_the_end_and_kill_does_not_ask() -> None:
    history = History(Unit("/a"), Unit("/b")).running()
    assert history.happens(RestartWanted("/a")) == [Signal("/a", SIGINT)]
    assert history.happens(Exited("/a", CLEAN)) == [Start("/a")]
    assert history.happens(StopWanted("/a", kill=True)) == []  # not there yet
    assert history.happens(Started("/a", 7)) == [Signal("/a", SIGKILL)]


def test_wishes_about_core_and_unknown_nodes_are_refused_and_a_stop_forgets_all() -> None:
    history = History(Unit("/a"), own_master=True).running()
    for name in ("master", "/nobody"):
        [told] = history.happens(StopWanted(name))
        assert isinstance(told, TellWish)
        assert told.refused
    history.happens(RestartWanted("/a"), StopRequested("SIGINT"))
    assert Start("/a") not in history.happens(Exited("/a", CLEAN))
    assert history.happens(StartWanted("/a")) == []


def test_another_master_gets_the_parameters_and_every_node_starts_again() -> None:
    history = History(Unit("/a"), Unit("/b"), Unit("/c", respawn=True, respawn_delay=1.0)).running()
    history.happens(Exited("/b", FAILED), Exited("/c", FAILED))
    assert history.happens(MasterReplaced()) == [TellRevival(), SetParameters()]
    history.happens(Tick(), after=2.0)  # nothing starts before the parameters are there
    assert history.happens(ParametersSet()) == [Signal("/a", SIGINT), Start("/c")]
    assert history.happens(Exited("/a", CLEAN)) == [Start("/a")]


def test_master_that_goes_again_while_parameters_are_set_does_not_end_the_run() -> None:
    history = History(Unit("/a")).running()
    history.happens(MasterReplaced())
    assert history.happens(SetupFailed("gone")) == []
    assert history.state.phase is Phase.RUNNING
    assert history.happens(MasterReplaced()) == [TellRevival(), SetParameters()]


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
    st.builds(StartWanted, _NAMES),
    st.builds(StopWanted, _NAMES, st.booleans()),
    st.builds(RestartWanted, _NAMES),
    st.just(MasterLost()),
    st.just(MasterReturned()),
    st.just(MasterReplaced()),
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
            if isinstance(action, Start):
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
        if state.phase is Phase.DONE or deadline is None:
            break
        now = max(now, deadline)
        follow(Tick())
    assert state.phase is Phase.DONE
    assert finished == 1
    assert now - stop <= 9.0  # nobody answers, not even to SIGKILL
