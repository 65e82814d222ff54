"""Taking back the serial line of a Raspberry Pi's header over the connection to the robot."""

from collections.abc import Sequence
from dataclasses import replace

from tests.robot.setup.raspberry_pi.test_header import BOARD, COMMAND, CONFIG, LINE, facts, texts

from ur.robot.setup.change import Change
from ur.robot.setup.facts import ABSENT, ComputerFacts
from ur.robot.setup.raspberry_pi.header import BEHIND, undo_header, want_header
from ur.robot.ssh.shell import LocalShell, Shell


def run(seen: ComputerFacts, applied: list[Change]) -> list[str]:
    """Take back what is to be taken back on a robot with these files. Returns the lines that report it."""
    lines: list[str] = []
    needed = {each: ABSENT for item in want_header(seen, BEHIND) for each in item.request("ros").files}
    more = replace(seen, files={**needed, **seen.files})

    def look(_shell: Shell, wanted: Sequence[object], *_: object, **__: object) -> ComputerFacts:
        return more if wanted else seen

    def apply(_shell: Shell, change: Change) -> None:
        applied.append(change)

    count = undo_header(LocalShell(), "ros", lines.append, look, apply)
    assert count == len(applied)
    return lines


def test_lines_and_console_are_given_back_and_reported() -> None:
    before = facts()
    (item,) = want_header(before, BOARD)
    applied: list[Change] = []
    lines = run(facts(*texts(item.plan(before))), applied)
    assert lines == ["header of the Raspberry Pi: taken back, from the next boot on"]
    assert texts(applied[0]) == ["arm_64bit=1\n", LINE]
    assert {CONFIG, COMMAND} <= set(applied[0].difference.split())


def test_robot_whose_firmware_was_not_changed_has_nothing_to_take_back() -> None:
    applied: list[Change] = []
    assert run(facts(), applied) == []
    assert applied == []
