"""Histories: what people want of one node."""

from signal import SIGINT, SIGKILL, SIGTERM

from tests.run.histories import CLEAN, FAILED, KILLED, RunHistory

from ur.run.supervisor.actions import ReportDeath, ReportPressure, ReportRequest, SignalUnit, StartUnit
from ur.run.supervisor.events import Exited, KillNode, RestartNode, Started, StartNode, StopNode, StopRequested, Tick
from ur.run.supervisor.state import RunPhase, TimeLimits, Unit
from ur.run.supervisor.supervisor import next_deadline


def test_storm_of_deaths_ends_with_giving_up_and_a_restart_by_hand_begins_anew() -> None:
    history = RunHistory(Unit("/a", respawn=True), Unit("/b")).running()
    for _ in range(TimeLimits().quick_deaths - 1):
        history.happens(Exited("/a", FAILED), after=0.1)
        history.happens(Tick(), after=history.due())
        history.happens(Started("/a", 5))
    assert history.happens(Exited("/a", FAILED)) == [ReportDeath("/a", FAILED, deaths=TimeLimits().quick_deaths)]
    assert next_deadline(history.state) is None
    assert history.happens(RestartNode("/a")) == [StartUnit("/a")]
    history.happens(Started("/a", 6))
    [death] = history.happens(Exited("/a", FAILED))
    assert isinstance(death, ReportDeath)
    assert death.restart_in == 0.0


def test_node_stopped_by_hand_stays_stopped_and_keeps_the_run() -> None:
    history = RunHistory(Unit("/a", respawn=True), Unit("/b", required=True)).running()
    for name in ("/a", "/b"):
        assert history.happens(StopNode(name)) == [SignalUnit(name, SIGINT)]
        assert history.happens(Exited(name, FAILED)) == [ReportRequest(name)]
    assert history.state.phase is RunPhase.RUNNING
    assert next_deadline(history.state) is None
    assert history.happens(StartNode("/a")) == [StartUnit("/a")]


def test_stubborn_node_stopped_by_hand_gets_stronger_signals() -> None:
    history = RunHistory(Unit("/a"), Unit("/b")).running()
    history.happens(StopNode("/a"))
    assert history.happens(Tick(), after=history.due()) == [ReportPressure(("/a",), SIGTERM), SignalUnit("/a", SIGTERM)]
    assert history.happens(Tick(), after=history.due()) == [ReportPressure(("/a",), SIGKILL), SignalUnit("/a", SIGKILL)]
    history.happens(Tick(), after=history.due())
    assert next_deadline(history.state) is None
    assert history.happens(Exited("/a", KILLED)) == [ReportRequest("/a")]


def test_restart_by_hand_waits_for_the_end_and_kill_does_not_ask() -> None:
    history = RunHistory(Unit("/a"), Unit("/b")).running()
    assert history.happens(RestartNode("/a")) == [SignalUnit("/a", SIGINT)]
    assert history.happens(Exited("/a", CLEAN)) == [StartUnit("/a")]
    assert history.happens(KillNode("/a")) == []  # not there yet
    assert history.happens(Started("/a", 7)) == [SignalUnit("/a", SIGKILL)]


def test_requests_about_core_and_unknown_nodes_are_refused_and_a_stop_forgets_all() -> None:
    history = RunHistory(Unit("/a"), own_master=True).running()
    for name in ("master", "/nobody"):
        [told] = history.happens(StopNode(name))
        assert isinstance(told, ReportRequest)
        assert told.refused
    history.happens(RestartNode("/a"), StopRequested("SIGINT"))
    assert StartUnit("/a") not in history.happens(Exited("/a", CLEAN))
    assert history.happens(StartNode("/a")) == []
