"""Taking back the serial line of a Raspberry Pi's header over the connection to the robot."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import pytest
from tests.robot.setup.raspberry_pi.test_header import BOARD, COMMAND, CONFIG, LINE, facts, texts

from ur.robot.setup.change import Change
from ur.robot.setup.facts import ABSENT, ComputerFacts
from ur.robot.setup.login import Task
from ur.robot.setup.raspberry_pi import take_back
from ur.robot.setup.raspberry_pi.header import BEHIND, want_header
from ur.robot.setup.robot_states import WantedRobot
from ur.robot.ssh.address import Address


@pytest.fixture
def applied(monkeypatch: pytest.MonkeyPatch) -> list[Change]:
    """A robot without a network: the changes that reach it."""
    changes: list[Change] = []

    @contextmanager
    def open_robot(_task: Task, _report: object) -> Iterator[None]:
        yield None

    monkeypatch.setattr(take_back, "open_robot", open_robot)
    monkeypatch.setattr(take_back, "apply_change", lambda _shell, change: changes.append(change))
    return changes


def meet(patch: pytest.MonkeyPatch, seen: ComputerFacts) -> Task:
    """A robot with these files."""
    patch.setattr(take_back, "gather", lambda *_, **__: seen)
    needed = {each: ABSENT for item in want_header(seen, BEHIND) for each in item.request("ros").files}
    more = replace(seen, files={**needed, **seen.files})
    patch.setattr(take_back, "gather_facts", lambda *_, **__: more)
    return Task(Address("ros", "bob.local"), WantedRobot("bob", "create2"))


def test_lines_and_console_are_given_back_and_reported(monkeypatch: pytest.MonkeyPatch, applied: list[Change]) -> None:
    before = facts()
    (item,) = want_header(before, BOARD)
    task, lines = meet(monkeypatch, facts(*texts(item.plan(before)))), list[str]()
    assert take_back.take_back_header(task, lines.append) == 1
    assert lines == ["header of the Raspberry Pi: taken back, from the next boot on"]
    assert texts(applied[0]) == ["arm_64bit=1\n", LINE]
    assert {CONFIG, COMMAND} <= set(applied[0].difference.split())


def test_robot_whose_firmware_was_not_changed_has_nothing_to_take_back(
    monkeypatch: pytest.MonkeyPatch, applied: list[Change]
) -> None:
    task = meet(monkeypatch, facts())
    assert take_back.take_back_header(task, lambda _: None) == 0
    assert applied == []
