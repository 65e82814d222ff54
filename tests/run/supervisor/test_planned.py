"""What events start, print and end, beside the normal start of a run."""

from tests.run.histories import CLEAN, FAILED

from ur.launchfile.plan.specs import Trigger
from ur.run.supervisor.actions import Action, ReportPlanned, ReportStop, StartUnit
from ur.run.supervisor.events import Begin, Event, Exited, ParametersSet, Printed, Started, StopRequested, Tick
from ur.run.supervisor.planned import list_triggers
from ur.run.supervisor.state import Effect, EndPlanned, Planned, PrintPlanned, RunPhase, StartPlanned, State, Unit
from ur.run.supervisor.supervisor import begin_state, next_deadline, step

FIRST, LATER = Unit("/first"), Unit("/later", planned=True)
WITH_START, ON_EXIT = Trigger("start", "/first"), Trigger("exit", "/first")


class Story:
    """A run of two units whose clock a test sets."""

    def __init__(self, *planned: tuple[Effect, Trigger | None], units: tuple[Unit, ...] = (FIRST, LATER)) -> None:
        effects = tuple(Planned(effect, list_triggers(trigger)) for effect, trigger in planned)
        self.state: State = begin_state(units, own_master=False, planned=effects)
        self.happens(Begin())

    def happens(self, event: Event, now: float = 0.0) -> list[Action]:
        """The actions that follow from an event, without reports of deaths."""
        self.state, actions = step(self.state, event, now)
        return [each for each in actions if isinstance(each, ReportPlanned | ReportStop | StartUnit)]

    def is_over(self) -> bool:
        return self.state.phase not in (RunPhase.PARAMETERS, RunPhase.RUNNING)


def test_unit_starts_when_another_has_ended_and_the_run_goes_on() -> None:
    story = Story((StartPlanned("/later"), ON_EXIT))
    assert story.happens(ParametersSet()) == [StartUnit("/first")]
    assert story.happens(Started("/first", 1)) == []
    assert story.happens(Exited("/first", FAILED)) == [StartUnit("/later")]
    assert not story.is_over()
    story.happens(Started("/later", 2))
    assert story.happens(Exited("/later", CLEAN)) == [ReportStop("every node has ended")]


def test_run_ends_with_its_last_unit_when_nothing_can_start_the_others() -> None:
    story = Story((StartPlanned("/later"), Trigger("exit", "/missing")))
    story.happens(ParametersSet())
    story.happens(Started("/first", 1))
    assert story.happens(Exited("/first", CLEAN)) == [ReportStop("every node has ended")]


def test_timer_of_the_run_counts_from_its_beginning_and_holds_it_open() -> None:
    story = Story((StartPlanned("/later"), Trigger("timer", seconds=5.0)))
    story.happens(ParametersSet(), 10.0)
    assert next_deadline(story.state) == 15.0
    story.happens(Started("/first", 1), 10.1)
    assert story.happens(Exited("/first", CLEAN), 11.0) == []
    assert story.happens(Tick(), 14.9) == []
    assert story.happens(Tick(), 15.0) == [StartUnit("/later")]


def test_timer_behind_an_event_counts_from_that() -> None:
    story = Story((PrintPlanned("now"), Trigger("timer", seconds=2.0, after=WITH_START)))
    story.happens(ParametersSet(), 0.0)
    assert next_deadline(story.state) is None
    story.happens(Started("/first", 1), 3.0)
    assert story.happens(Tick(), 4.9) == []
    assert story.happens(Tick(), 5.0) == [ReportPlanned("now")]
    assert story.happens(Tick(), 6.0) == []


def test_lines_without_an_event_are_printed_once_at_the_start() -> None:
    story = Story((PrintPlanned("hello"), None))
    assert story.happens(ParametersSet()) == [StartUnit("/first"), ReportPlanned("hello")]
    assert story.happens(Started("/first", 1)) == []


def test_output_of_a_unit_is_an_event() -> None:
    story = Story((StartPlanned("/later"), Trigger("output", "/first")))
    story.happens(ParametersSet())
    assert story.happens(Printed("/other")) == []
    assert story.happens(Printed("/first")) == [StartUnit("/later")]


def test_planned_end_stops_the_run_with_its_reason() -> None:
    story = Story((EndPlanned("the map is saved"), ON_EXIT), units=(FIRST,))
    story.happens(ParametersSet())
    story.happens(Started("/first", 1))
    assert story.happens(Exited("/first", CLEAN)) == [ReportStop("the map is saved")]


def test_lines_of_the_end_are_printed_when_the_run_stops_and_nothing_starts_then() -> None:
    story = Story((PrintPlanned("bye"), Trigger("shutdown")), (StartPlanned("/later"), Trigger("shutdown")))
    story.happens(ParametersSet())
    story.happens(Started("/first", 1))
    assert story.happens(StopRequested("asked for")) == [ReportStop("asked for"), ReportPlanned("bye")]


def test_state_is_reached_when_the_program_that_awaits_it_ends_well() -> None:
    story = Story((StartPlanned("/later"), Trigger("state", "/first")))
    story.happens(ParametersSet())
    story.happens(Started("/first", 1))
    assert story.happens(Exited("/first", FAILED)) == [ReportStop("every node has ended")]


def test_end_of_a_helper_is_none_of_the_ends_that_a_file_means() -> None:
    story = Story((PrintPlanned("one has ended"), Trigger("exit")), units=(FIRST, Unit("/first/load", helper=True)))
    story.happens(ParametersSet())
    story.happens(Started("/first", 1))
    story.happens(Started("/first/load", 2))
    assert story.happens(Exited("/first/load", CLEAN)) == []
    lines = [ReportPlanned("one has ended"), ReportStop("every node has ended")]
    assert story.happens(Exited("/first", CLEAN)) == lines


def test_helper_alone_does_not_keep_a_run_going() -> None:
    story = Story(units=(FIRST, Unit("/first/load", helper=True)))
    story.happens(ParametersSet())
    story.happens(Started("/first", 1))
    story.happens(Started("/first/load", 2))
    assert story.happens(Exited("/first", CLEAN)) == [ReportStop("every node has ended")]


def test_unit_is_restarted_as_often_as_it_may() -> None:
    story = Story(units=(Unit("/first", respawn=True, retries=1),))
    story.happens(ParametersSet())
    story.happens(Started("/first", 1))
    story.happens(Exited("/first", FAILED), 1.0)
    assert story.happens(Tick(), 1.0) == [StartUnit("/first")]
    story.happens(Started("/first", 2), 1.0)
    assert story.happens(Exited("/first", FAILED), 2.0) == [ReportStop("every node has ended")]
