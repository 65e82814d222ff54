"""Histories: how a run ends."""

from signal import SIGINT, SIGKILL, SIGTERM

from tests.run.histories import CLEAN, KILLED, RunHistory

from ur.run.supervisor.actions import Finish, ReportPressure, ReportStop, SignalUnit, Sweep
from ur.run.supervisor.events import Begin, Exited, NothingLeft, ParametersSet, Started, StopRequested, Tick
from ur.run.supervisor.state import RunPhase, Unit
from ur.run.supervisor.supervisor import next_deadline


def test_stop_interrupts_all_nodes_at_once_then_rosout_then_master() -> None:
    history = RunHistory(Unit("/a"), Unit("/b"), own_master=True).running()
    assert history.happens(StopRequested("SIGINT")) == [
        ReportStop("SIGINT"),
        SignalUnit("/a", SIGINT),
        SignalUnit("/b", SIGINT),
    ]
    assert history.happens(Exited("/a", KILLED)) == []
    assert history.happens(Exited("/b", CLEAN)) == [SignalUnit("/rosout", SIGINT)]
    assert history.happens(Exited("/rosout", CLEAN)) == [SignalUnit("master", SIGINT)]
    assert history.happens(Exited("master", CLEAN)) == [Sweep(SIGTERM)]
    assert history.happens(NothingLeft()) == [Finish(0)]
    assert history.state.phase is RunPhase.DONE


def test_stubborn_nodes_get_stronger_signals_within_5_seconds() -> None:
    history = RunHistory(Unit("/a"), Unit("/b"), own_master=True).running()
    begin = history.now
    history.happens(StopRequested("SIGINT"), Exited("/b", CLEAN))
    assert history.happens(Tick(), after=history.due()) == [ReportPressure(("/a",), SIGTERM), SignalUnit("/a", SIGTERM)]
    assert history.happens(Tick(), after=history.due()) == [ReportPressure(("/a",), SIGKILL), SignalUnit("/a", SIGKILL)]
    assert history.happens(Exited("/a", KILLED)) == [SignalUnit("/rosout", SIGINT)]
    assert history.happens(Tick(), after=history.due()) == [
        SignalUnit("master", SIGKILL),
        SignalUnit("/rosout", SIGKILL),
    ]
    history.happens(Exited("master", KILLED), Exited("/rosout", KILLED))
    assert history.happens(Tick(), after=history.due()) == [Sweep(SIGKILL)]
    assert history.happens(NothingLeft()) == [Finish(0)]
    assert history.now - begin < 5.0


def test_asking_again_to_stop_is_faster() -> None:
    history = RunHistory(Unit("/a")).running()
    history.happens(StopRequested("SIGINT"))
    assert SignalUnit("/a", SIGTERM) in history.happens(StopRequested("SIGINT"))
    assert SignalUnit("/a", SIGKILL) in history.happens(StopRequested("SIGINT"))


def test_process_that_hangs_in_the_kernel_does_not_hang_the_run() -> None:
    history = RunHistory(Unit("/a")).running()
    history.happens(StopRequested("SIGINT"))
    for _ in range(20):
        if history.state.phase is RunPhase.DONE:
            break
        history.happens(Tick(), after=history.due())
    assert history.state.phase is RunPhase.DONE


def test_stop_before_a_process_is_there_reaches_it_later() -> None:
    history = RunHistory(Unit("/a"))
    history.happens(Begin(), ParametersSet(), StopRequested("SIGINT"))
    assert history.happens(Started("/a", 1)) == [SignalUnit("/a", SIGINT)]


def test_master_without_nodes_runs_until_asked_to_stop() -> None:
    history = RunHistory(own_master=True).running()
    assert next_deadline(history.state) is None
    assert history.happens(StopRequested("SIGINT"))[-1] == SignalUnit("/rosout", SIGINT)
