"""Calls of services for a launch file: in their order, again while nobody offers one, until a state is reached."""

from collections.abc import Callable
from typing import Any

import pytest

from ur_nodes.launch_steps_node import LaunchSteps, Step
from ur_nodes.ports.raw import ServiceAnswer
from ur_nodes.ports.values import Result

MISSING = Result(success=False, text="/lc/change_state: no node offers it now")


class Robot:
    """Stands for a node and for the services that it calls: each gives its answers one after the other."""

    def __init__(self, **answers: list[Result]) -> None:
        self.answers = answers
        self.called: list[str] = []
        self.said: list[str] = []
        self.end_: tuple[str, bool] | None = None
        self.raw = self.log = self

    def post(self, do: Callable[[], None]) -> None:
        do()

    def after(self, _seconds: float, do: Callable[[], None], *, steady: bool) -> None:
        assert steady
        do()

    def info(self, text: str) -> None:
        self.said.append(text)

    def end(self, cause: str, *, failed: bool = False) -> None:
        self.end_ = cause, failed

    def call(self, service: str, _fields: dict[str, object], take: Callable[[Result], None]) -> None:
        self.called.append(service)
        take(self.answers[service].pop(0))


def answer(**fields: Any) -> Result:
    return Result(success=True, value=ServiceAnswer("lifecycle_msgs/srv/ChangeState", fields))


def state(label: str) -> Result:
    return answer(current_state={"id": 1, "label": label})


def run(robot: Robot, *steps: Step) -> Robot:
    LaunchSteps(robot, list(steps))  # type: ignore[arg-type]
    return robot


def test_calls_are_made_in_their_order_and_then_it_ends() -> None:
    robot = Robot(a=[answer(success=True)], b=[answer()])
    run(robot, Step("a", {}, "first"), Step("b", {}, "second"))
    assert robot.called == ["a", "b"]
    assert robot.said == ["first: done", "second: done"]
    assert robot.end_ == ("all is done", False)


def test_service_that_no_node_offers_yet_is_called_again() -> None:
    robot = run(Robot(a=[MISSING, MISSING, answer(success=True)]), Step("a", {}, "it"))
    assert robot.called == ["a"] * 3
    assert robot.end_ == ("all is done", False)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (Result(success=False, text="it ended"), "it: it ended"),
        (answer(success=False), "it by a: it is refused"),
        (answer(success=False, error_message="no such plugin"), "it by a: no such plugin"),
    ],
)
def test_failure_ends_it_with_its_reason_before_the_next_call(given: Result, told: str) -> None:
    robot = run(Robot(a=[given]), Step("a", {}, "it"), Step("b", {}, "never"))
    assert robot.called == ["a"]
    assert robot.end_ == (told, True)


@pytest.mark.parametrize(("until", "calls"), [("active", 3), ("", 2)])
def test_call_is_repeated_until_the_state_is_reached_or_is_another(until: str, calls: int) -> None:
    robot = run(Robot(a=[state("inactive"), state("activating"), state("active")]), Step("a", {}, until=until))
    assert robot.called == ["a"] * calls
    assert robot.end_ == ("all is done", False)
