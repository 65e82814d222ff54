import threading
import time
from collections.abc import Callable, Iterator

import pytest

from ur.request.remote.share_again import Health, ShareAgain, parse_health
from ur.source.diagnostic import UserError, error

RESTARTED, RUNNING, STOPPING = Health(20.0, False), Health(9000.0, False), Health(9000.0, True)
HAS_MASTER = Health(9000.0, False, master=True)


def make(
    healths: list[Health | None],
    begun: list[str],
    problem: str = "",
    clock: Callable[[], float] = time.monotonic,
) -> ShareAgain:
    answers: Iterator[Health | None] = iter(healths)

    def examine() -> Health:
        health = next(answers)
        if health is None:
            raise UserError(error("bob does not answer", rule="test"))
        return health

    def begin() -> tuple[str, str]:
        begun.append("begun")
        return "chat.2", problem

    command = "ur launch chat chat.launch"
    return ShareAgain("bob", examine, begin, lambda: 600.0, command, clock=clock, pause=0.0)


def test_share_starts_again_once_the_robot_has_restarted() -> None:
    begun: list[str] = []
    assert make([STOPPING, None, None, RESTARTED], begun).start() == ""
    assert begun == ["begun"]


def test_share_whose_master_does_not_return_is_not_started_again() -> None:
    times = iter((0.0, 0.0, 10.0, 40.0))
    begun: list[str] = []
    told = make([RUNNING, RUNNING, RUNNING], begun, clock=lambda: next(times)).start()
    assert told.splitlines() == [
        "bob: its nodes were not started again: it has no ROS master",
        "  help: start them again: ur launch chat chat.launch",
    ]
    assert begun == []


def test_share_is_found_again_when_only_the_master_was_replaced() -> None:
    begun: list[str] = []
    assert make([RUNNING, HAS_MASTER], begun).start() == ""
    assert begun == ["begun"]


def test_share_that_does_not_start_is_told_with_its_reason() -> None:
    told = make([RESTARTED], [], "no package chat").start()
    assert "its nodes do not start again: no package chat" in told


def test_robot_that_never_comes_back_is_given_up() -> None:
    times = iter(range(0, 1000, 50))
    told = make([None] * 20, [], clock=lambda: float(next(times))).start()
    assert "were not started again: bob does not answer" in told


def test_ending_run_starts_nothing_any_more() -> None:
    begun: list[str] = []
    again = make([RESTARTED], begun)
    again.close()
    assert again.start() != ""
    assert begun == []


def test_end_waits_for_a_share_that_is_being_started() -> None:
    inside, go_on = threading.Event(), threading.Event()

    def begin() -> tuple[str, str]:
        inside.set()
        assert go_on.wait(60.0)
        return "chat.2", ""

    again = ShareAgain("bob", lambda: RESTARTED, begin, lambda: 600.0, "")
    starter = threading.Thread(target=again.start)
    starter.start()
    assert inside.wait(60.0)
    closer = threading.Thread(target=again.close)
    closer.start()
    assert again.over.wait(60.0)
    assert closer.is_alive()
    go_on.set()
    closer.join(60.0)
    starter.join(60.0)
    assert not closer.is_alive()


@pytest.mark.parametrize(
    ("text", "health"),
    [
        ("100.5 50 100 running\n", Health(100.0, False)),
        ("9000.0 800000 100 stopping\n", Health(1000.0, True)),
        ("100.5 50 100\n", Health(100.0, False)),
        ("", Health(float("inf"), False)),
    ],
)
def test_health_is_read_from_what_the_robot_prints(text: str, health: Health) -> None:
    assert parse_health(text) == health
