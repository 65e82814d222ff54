"""Histories: how units end, and come again."""

from signal import SIGINT, SIGTERM

import pytest
from tests.run.histories import CLEAN, FAILED, KILLED, RunHistory

from ur.run.supervisor.actions import Finish, ReportDeath, ReportStop, SignalUnit, StartUnit, Sweep
from ur.run.supervisor.events import (
    Begin,
    Evicted,
    Exited,
    MasterAnswered,
    NothingLeft,
    OwnerEnded,
    ParametersSet,
    Started,
    StartFailed,
    StopRequested,
    Tick,
    Unregistered,
)
from ur.run.supervisor.state import ExitStatus, TimeLimits, Unit
from ur.run.supervisor.supervisor import begin_state


def test_required_node_that_fails_ends_the_run_as_roslaunch_with_0() -> None:
    history = RunHistory(Unit("/a", required=True), Unit("/b")).running()
    assert history.happens(Exited("/a", FAILED)) == [
        ReportDeath("/a", FAILED, ends_run=True),
        ReportStop("/a is required and has ended"),
        SignalUnit("/b", SIGINT),
    ]
    history.happens(Exited("/b", CLEAN), NothingLeft())
    assert history.happens(Unregistered()) == [Finish(0)]


@pytest.mark.parametrize(("status", "code"), [(CLEAN, 0), (FAILED, 1), (KILLED, 1)])
def test_program_has_failed_when_a_required_node_of_it_has(status: ExitStatus, code: int) -> None:
    history = RunHistory(Unit("/a", required=True), limits=TimeLimits(failures_count=True)).running()
    history.happens(Exited("/a", status), NothingLeft())
    assert history.happens(Unregistered()) == [Finish(code)]


@pytest.mark.parametrize(
    ("status", "code", "told"), [(CLEAN, 0, False), (FAILED, 3, False), (KILLED, 137, True), (ExitStatus(), 127, True)]
)
def test_terminal_node_ends_the_run_with_its_exit_code(status: ExitStatus, code: int, told: bool) -> None:
    history = RunHistory(Unit("/front", terminal=True, required=True)).running()
    actions = history.happens(Exited("/front", status))
    assert any(isinstance(action, ReportDeath) for action in actions) is told
    history.happens(NothingLeft())
    assert history.happens(Unregistered()) == [Finish(code)]


def test_run_ends_when_every_node_has_ended() -> None:
    history = RunHistory(Unit("/a"), Unit("/b"), own_master=True).running()
    assert history.happens(Exited("/a", CLEAN)) == [ReportDeath("/a", CLEAN)]
    assert history.happens(Exited("/b", FAILED)) == [
        ReportDeath("/b", FAILED),
        ReportStop("every node has ended"),
        SignalUnit("/rosout", SIGINT),
    ]


def test_run_that_started_nothing_ends_with_1() -> None:
    history = RunHistory(Unit("/a"))
    history.happens(Begin(), ParametersSet())
    told = history.happens(StartFailed("/a", "no such file"))
    assert told[0] == ReportDeath("/a", ExitStatus(), "no such file")
    history.happens(NothingLeft())
    assert history.happens(Unregistered()) == [Finish(1)]


def test_respawn_waits_its_delay_and_node_that_keeps_dying_comes_ever_later() -> None:
    history = RunHistory(Unit("/a", respawn=True, respawn_delay=0.5), Unit("/b")).running()
    delays = []
    for _ in range(9):
        [death] = history.happens(Exited("/a", FAILED), after=0.1)
        assert isinstance(death, ReportDeath)
        delays.append(death.restart_in)
        assert history.happens(Tick(), after=history.due() - 0.01) == []
        assert history.happens(Tick(), after=0.02) == [StartUnit("/a")]
        history.happens(Started("/a", 5))
    assert delays == [0.5, 0.5, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 30.0]
    [death] = history.happens(Exited("/a", FAILED), after=TimeLimits().quick_death)
    assert isinstance(death, ReportDeath)
    assert death.restart_in == 0.5


def test_node_waiting_for_its_respawn_does_not_hold_the_stop_up() -> None:
    history = RunHistory(Unit("/a", respawn=True, respawn_delay=60.0)).running()
    history.happens(Exited("/a", FAILED))
    assert history.happens(StopRequested("SIGINT")) == [ReportStop("SIGINT"), Sweep(SIGTERM)]


def test_late_news_about_unknown_or_ended_units_change_nothing() -> None:
    history = RunHistory(Unit("/a"), Unit("/b")).running()
    history.happens(Exited("/a", CLEAN))
    before = history.state
    assert history.happens(Exited("/a", FAILED), Exited("/nobody", CLEAN), Started("/a", 9), MasterAnswered()) == []
    assert history.state == before


def test_node_that_refuses_its_input_is_given_up_sooner_and_ends_the_run_with_1() -> None:
    history = RunHistory(Unit("/a", respawn=True)).running()
    refused = ExitStatus(code=2)
    for _ in range(2):
        history.happens(Exited("/a", refused))
        history.happens(Tick(), after=history.due())
        history.happens(Started("/a", 5))
    told = history.happens(Exited("/a", refused))
    assert told[:2] == [ReportDeath("/a", refused, deaths=3), ReportStop("every node has ended")]
    history.happens(NothingLeft())
    assert history.happens(Unregistered()) == [Finish(1)]


def test_no_limit_respawns_for_ever() -> None:
    history = RunHistory(Unit("/a", respawn=True))
    history.state = begin_state([Unit("/a", respawn=True)], own_master=False, limits=TimeLimits(quick_deaths=0))
    history.running()
    for _ in range(40):
        history.happens(Exited("/a", FAILED))
        assert history.happens(Tick(), after=history.due()) == [StartUnit("/a")]
        history.happens(Started("/a", 5))


def test_evicted_node_is_not_started_again_and_the_run_ends_with_1() -> None:
    history = RunHistory(Unit("/a", respawn=True), Unit("/b")).running()
    told = history.happens(Evicted("/a", CLEAN, "run other.7"))
    assert told == [ReportDeath("/a", CLEAN, evicted_by="run other.7")]
    history.happens(Exited("/b", CLEAN), NothingLeft())
    assert history.happens(Unregistered()) == [Finish(1)]


@pytest.mark.parametrize("unit", [Unit("/a", required=True), Unit("/a", terminal=True, required=True)])
def test_run_ends_with_1_when_the_node_that_it_needs_is_evicted(unit: Unit) -> None:
    history = RunHistory(unit, Unit("/b")).running()
    told = history.happens(Evicted("/a", CLEAN, "process 7"))
    assert told[0] == ReportDeath("/a", CLEAN, ends_run=True, evicted_by="process 7")
    history.happens(Exited("/b", CLEAN), NothingLeft())
    assert history.happens(Unregistered()) == [Finish(1)]


def test_run_ends_with_1_when_a_run_that_it_has_joined_ends_and_hears_it_once() -> None:
    history = RunHistory(Unit("/a")).running()
    told = history.happens(OwnerEnded("first.1 ends"))
    assert told == [ReportStop("first.1 ends", failed=True), SignalUnit("/a", SIGINT)]
    assert history.happens(OwnerEnded("second.2 ends")) == []
    history.happens(Exited("/a", CLEAN), NothingLeft())
    assert history.happens(Unregistered()) == [Finish(1)]
