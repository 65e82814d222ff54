"""Taking back the serial line of a Raspberry Pi's header over the connection to the robot."""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.robot.setup.raspberry_pi.test_header import BOARD, COMMAND, CONFIG, LINE, facts, texts

from ur.robot.setup.change import Change
from ur.robot.setup.facts import ABSENT, ComputerFacts
from ur.robot.setup.raspberry_pi import take_back
from ur.robot.setup.raspberry_pi.header import BEHIND, want_header
from ur.robot.ssh.shell import LocalShell


@pytest.fixture
def applied(monkeypatch: pytest.MonkeyPatch) -> list[Change]:
    """The changes that reach the robot."""
    changes: list[Change] = []
    monkeypatch.setattr(take_back, "apply_change", lambda _shell, change: changes.append(change))
    return changes


def run(patch: pytest.MonkeyPatch, seen: ComputerFacts, lines: list[str]) -> int:
    """Take back what is to be taken back on a robot with these files."""
    needed = {each: ABSENT for item in want_header(seen, BEHIND) for each in item.request("ros").files}
    more = replace(seen, files={**needed, **seen.files})
    patch.setattr(take_back, "gather", lambda *_, **__: seen)
    patch.setattr(take_back, "gather_facts", lambda *_, **__: more)
    return take_back.take_back_header(LocalShell(), "ros", lines.append)


def test_lines_and_console_are_given_back_and_reported(monkeypatch: pytest.MonkeyPatch, applied: list[Change]) -> None:
    before = facts()
    (item,) = want_header(before, BOARD)
    lines: list[str] = []
    assert run(monkeypatch, facts(*texts(item.plan(before))), lines) == 1
    assert lines == ["header of the Raspberry Pi: taken back, from the next boot on"]
    assert texts(applied[0]) == ["arm_64bit=1\n", LINE]
    assert {CONFIG, COMMAND} <= set(applied[0].difference.split())


def test_robot_whose_firmware_was_not_changed_has_nothing_to_take_back(
    monkeypatch: pytest.MonkeyPatch, applied: list[Change]
) -> None:
    assert run(monkeypatch, facts(), []) == 0
    assert applied == []
