"""Effects that events have: which event starts a unit, prints a line, or ends the run. Pure."""

from collections.abc import Iterable

from ur.launchfile.plan.specs import Trigger
from ur.run.supervisor.events import Event, Exited, ParametersSet, Printed, Started, StartFailed
from ur.run.supervisor.state import CancelPlanned, Effect, Planned, PrintPlanned, RunPhase, State
from ur.source.data_classes import replace


def list_triggers(trigger: Trigger | None) -> tuple[Trigger, ...]:
    """Return a trigger and those that it comes after, the first one first."""
    found: list[Trigger] = []
    while trigger is not None:
        found.insert(0, trigger)
        trigger = trigger.after
    return tuple(found)


def any_output(planned: Iterable[Planned]) -> bool:
    """Return whether an effect depends on what units print."""
    return any(trigger.kind == "output" for each in planned for trigger in each.triggers)


def note_effects(state: State, event: Event, now: float) -> State:
    """Return the state with the effects that an event has."""
    if not state.planned or state.phase not in (RunPhase.PARAMETERS, RunPhase.RUNNING):
        return state
    unit = state.find(getattr(event, "name", ""))
    planned, effects = advance(state.planned, event, now, of_helper=unit is not None and unit.unit.helper)
    for cancel in (each for each in effects if isinstance(each, CancelPlanned)):
        planned = tuple(each for each in planned if all(part.handler != cancel.handler for part in each.triggers))
    return replace(state, planned=planned, effects=tuple(e for e in effects if not isinstance(e, CancelPlanned)))


def advance(
    planned: Iterable[Planned], event: Event, now: float, *, of_helper: bool = False
) -> tuple[tuple[Planned, ...], list[Effect | CancelPlanned]]:
    """Return what is still planned after an event, and the effects that it has.

    The units of the launch file do not include helpers: only what awaits a state depends on their events.
    """
    left: list[Planned] = []
    effects: list[Effect | CancelPlanned] = []
    for each in planned:
        rest = each.triggers
        if each.due is not None and each.due <= now:
            following = _arm(replace(each, triggers=rest[1:], due=None), now)
        elif not rest and isinstance(event, ParametersSet):
            following = None
        elif rest and each.due is None and of_helper <= (rest[0].kind == "state") and _occurs(rest[0], event):
            # The first timer counts from the beginning, any other from the event before it
            following = _arm(each if rest[0].kind == "timer" else replace(each, triggers=rest[1:]), now)
        else:
            following = each
        if following is None:
            effects.append(each.effect)
        else:
            left.append(following)
    return tuple(left), effects


def collect_final(planned: Iterable[Planned]) -> list[str]:
    """Return the lines that the end of the run prints. Nothing is started then."""
    return [
        each.effect.text
        for each in planned
        if len(each.triggers) == 1 and each.triggers[0].kind == "shutdown" and isinstance(each.effect, PrintPlanned)
    ]


def _arm(planned: Planned, now: float) -> Planned | None:
    """Start the timer that comes first; return None if nothing is left to occur."""
    if not planned.triggers:
        return None
    first = planned.triggers[0]
    return replace(planned, due=now + first.seconds) if first.kind == "timer" else planned


def _occurs(trigger: Trigger, event: Event) -> bool:
    match trigger.kind, event:
        case "timer", ParametersSet():
            return True
        case "start", Started(name) if trigger.node in ("", name):
            return True
        case "exit", Exited(name) | StartFailed(name) if trigger.node in ("", name):
            return True
        case "state", Exited(name, status) if trigger.node == name and status.clean:
            return True  # the program that awaits the state
        case "output", Printed(name) if trigger.node in ("", name):
            return True
    return False
