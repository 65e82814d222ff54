"""Runs that are told what happens. No process anywhere."""

from __future__ import annotations

from ur.run.supervisor.actions import Action
from ur.run.supervisor.events import Begin, Event, MasterAnswered, ParametersSet, Started
from ur.run.supervisor.state import ExitStatus, State, TimeLimits, Unit
from ur.run.supervisor.supervisor import begin_state, next_deadline, step

CLEAN = ExitStatus(code=0)
FAILED = ExitStatus(code=3)
KILLED = ExitStatus(signal=9)
MASTER = Unit("master", core=True, required=True)
ROSOUT = Unit("/rosout", core=True, respawn=True)


class RunHistory:
    """A run that is being told what happens."""

    def __init__(self, *units: Unit, own_master: bool = False, limits: TimeLimits | None = None) -> None:
        core = (MASTER, ROSOUT) if own_master else ()
        self.state: State = begin_state([*units, *core], own_master=own_master, limits=limits)
        self.now = 100.0

    def happens(self, *events: Event, after: float = 0.0) -> list[Action]:
        self.now += after
        told: list[Action] = []
        for event in events:
            self.state, actions = step(self.state, event, self.now)
            told += actions
        return told

    def running(self) -> RunHistory:
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
