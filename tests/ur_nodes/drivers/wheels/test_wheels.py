"""The test of wheels off the ground: each board, wired in any way, with a person who reports what turned."""

import itertools
import os
import select
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.base_contract import PACKAGE, load
from tests.ur_nodes.drivers.wheels.lifted import CountedLine, LiftedPlant

from ur.robot.base import load_base
from ur.robot.base.wiring import WIRING_NAMES, Wiring, put_wiring
from ur.source.diagnostic import UserError
from ur_nodes.drivers.boards.board import RewiredBoard
from ur_nodes.drivers.registry import BOARDS, FIRMWARES, make_board
from ur_nodes.drivers.wheels.program import main, report, run_test
from ur_nodes.drivers.wheels.session import WheelSession
from ur_nodes.drivers.wheels.verdict import MOTIONS, WheelObservation, WheelVerdict, judge
from ur_nodes.simulator.devices.bench import DeviceTerminal

BASE = load("create2", "")
FILE = PACKAGE / "bases" / "create2" / "base.yaml"
WIRINGS = [
    Wiring(),
    Wiring(motors_swapped=True),
    Wiring(left_motor_reversed=True, left_counter_reversed=True),
    Wiring(counters_swapped=True, right_counter_reversed=True),
    Wiring(motors_swapped=True, right_motor_reversed=True, counters_swapped=True, left_counter_reversed=True),
]


class Person:
    """Answers as somebody does who looks at the wheels of a plant."""

    def __init__(self, line: CountedLine, begin: str = "y") -> None:
        self._plant, self._begin, self.asked = line.plant, begin, list[str]()
        self._expected = (0, 0)

    def ask(self, question: str) -> str:
        self.asked.append(question)
        if "[y/N]" in question:
            return self._begin
        if "Press Enter" in question:
            name = question.rpartition(": ")[2].strip()
            self._expected, self._plant.last = next(each.signs for each in MOTIONS if each.name == name), (0, 0)
            return ""
        if "[Y/n]" in question:
            return "y" if self._plant.last == self._expected else "n"
        return {1: "f", -1: "b", 0: "n"}[self._plant.last["right" in question]]


def examine(board: str, wiring: Wiring, begin: str = "y") -> tuple[WheelVerdict | None, Person, CountedLine]:
    line = CountedLine(board, wiring)
    session, person = WheelSession(line, BOARDS[board](BASE), BASE), Person(line, begin)
    session.wait()
    return run_test(session, person.ask, lambda _: None), person, line


@pytest.mark.parametrize("board", sorted(BOARDS))
@pytest.mark.parametrize("wiring", WIRINGS, ids=lambda each: "-".join(each.names) or "right")
def test_what_is_swapped_or_reversed_is_found(board: str, wiring: Wiring) -> None:
    assert examine(board, wiring)[0] == WheelVerdict(wiring)


def test_every_wiring_is_told_from_every_other_one() -> None:
    for chosen in itertools.product((False, True), repeat=len(WIRING_NAMES)):
        wiring = Wiring(**dict(zip(WIRING_NAMES, chosen, strict=True)))
        observations = []
        for motion in MOTIONS:
            left, right = (round(each) for each in wiring.turned(*motion.signs))
            counts = -left if wiring.left_counter_reversed else left, -right if wiring.right_counter_reversed else right
            counted = counts[::-1] if wiring.counters_swapped else counts
            observations.append(WheelObservation(motion, (left, right), (counted[0] * 0.1, counted[1] * 0.1)))
        assert judge(observations) == WheelVerdict(wiring)


@pytest.mark.parametrize("board", sorted(BOARDS))
def test_no_wheel_turns_before_the_person_agrees(board: str) -> None:
    verdict, person, line = examine(board, Wiring(), begin="")
    assert verdict is None
    assert len(person.asked) == 1
    assert line.plant.rolled() == (0.0, 0.0) or max(map(abs, line.plant.rolled())) < 0.01


def test_wheel_that_does_not_turn_is_named() -> None:
    line = CountedLine("arduino", Wiring())
    line.plant.stuck = (True, False)
    session = WheelSession(line, BOARDS["arduino"](BASE), BASE)
    session.wait()
    verdict = run_test(session, Person(line).ask, lambda _: None)
    assert verdict
    assert verdict.wiring is None
    assert verdict.problems == ("the left wheel did not turn: check its motor, its fuse and the emergency stop",)


def test_encoder_that_does_not_count_and_a_wrong_number_of_ticks_are_named() -> None:
    still = [WheelObservation(motion, motion.signs, (0.0, motion.signs[1] * 0.1)) for motion in MOTIONS]
    assert judge(still).problems == ("the board's left counter does not count: check that encoder and its cable",)
    double = [
        WheelObservation(motion, motion.signs, (motion.signs[0] * 0.1, motion.signs[1] * 0.2)) for motion in MOTIONS
    ]
    verdict = judge(double)
    assert verdict.wiring == Wiring()
    assert "right counter shows 0.20 m for 0.10 m: check `ticks_per_turn`" in verdict.problems[0]


def test_answers_that_contradict_each_other_change_nothing() -> None:
    same = [WheelObservation(motion, (1, 1), (0.1, 0.1)) for motion in MOTIONS]
    verdict = judge(same)
    assert verdict.wiring is None
    assert "contradict" in verdict.problems[0]


def test_board_that_is_silent_or_held_is_named_with_what_to_do() -> None:
    line = CountedLine("arduino", Wiring())
    line.firmware.power = False
    with pytest.raises(UserError, match=r"/dev/test: Arduino .* does not drive: its motors have no power"):
        WheelSession(line, BOARDS["arduino"](BASE), BASE).wait()
    line.firmware.receive, line.firmware.tick = (lambda _: b""), (lambda: b"")
    with pytest.raises(UserError, match=r"no wheel counts of Arduino .* for 6 s; is it switched on?"):
        WheelSession(line, BOARDS["arduino"](BASE), BASE).wait()


@pytest.mark.parametrize("wiring", WIRINGS[1:], ids=lambda each: "-".join(each.names))
def test_driver_with_the_wiring_of_its_base_file_turns_and_counts_as_the_robot_does(
    wiring: Wiring, tmp_path: Path
) -> None:
    folder = tmp_path / "bases" / "create2"
    folder.mkdir(parents=True)
    path = folder / "base.yaml"
    path.write_text(FILE.read_text())
    lines: list[str] = []
    assert report(WheelVerdict(wiring), path, BASE, lines.append) == 0
    assert "written to" in lines[0]
    base = load_base(tmp_path, "create2")
    assert base.driver
    assert base.driver.wiring == wiring
    board, line = make_board("create2", base), CountedLine("create2", wiring)
    assert isinstance(board, RewiredBoard)
    session = WheelSession(line, board, base)
    session.wait()
    counted = session.turn(MOTIONS[2])
    assert line.plant.last == (-1, 1)
    assert counted == pytest.approx((-0.1, 0.1), abs=0.02)
    assert report(WheelVerdict(wiring), path, base, lines.append) == 0
    assert lines[-1] == "ok: the wheels turn and count as the base file says"
    assert report(WheelVerdict(Wiring()), path, base, lines.append) == 0
    assert path.read_text() == FILE.read_text()


WIRED = "wiring: {motors_swapped: true}"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("a: 1\ndriver: magni # of 2018\nb: 2\n", f"a: 1\ndriver: {{protocol: magni, {WIRED}}} # of 2018\nb: 2\n"),
        (
            "driver: {protocol: arduino, device: /dev/ttyUSB0}\n",
            f"driver: {{protocol: arduino, device: /dev/ttyUSB0, {WIRED}}}\n",
        ),
        (
            "driver:\n  protocol: arduino\n  baud: 9600\n# next\nb: 2\n",
            f"driver: {{protocol: arduino, baud: 9600, {WIRED}}}\n# next\nb: 2\n",
        ),
        ("driver: magni", f"driver: {{protocol: magni, {WIRED}}}"),
        (
            "driver: {protocol: magni, wiring: {counters_swapped: true}}\n",
            f"driver: {{protocol: magni, {WIRED}}}\n",
        ),
        (
            "driver: magni\nvariants: {old: {driver: arduino}}\n",
            f"driver: magni\nvariants: {{old: {{driver: {{protocol: arduino, {WIRED}}}}}}}\n",
        ),
    ],
)
def test_wiring_changes_nothing_else_in_a_base_file(before: str, after: str) -> None:
    wiring = Wiring(motors_swapped=True)
    assert put_wiring(before, "old", wiring) == after
    assert put_wiring(after, "old", wiring) == after


def test_base_file_without_a_driver_gets_no_wiring() -> None:
    with pytest.raises(LookupError):
        put_wiring("a: 1\n", "", Wiring(motors_swapped=True))


def answer_in_a_terminal(folder: Path, keys: str, *arguments: str) -> tuple[int, str]:
    """Run the program behind a stand-in, type keys as it asks, and return its exit code and what it printed."""
    terminal = DeviceTerminal(folder / "create")
    plant = LiftedPlant(Wiring())
    firmware = FIRMWARES["create2"](plant)  # type: ignore[arg-type]
    person, theirs = os.openpty()
    argv = [sys.executable, "-m", "ur_nodes.drivers.wheels.program", "--package", str(PACKAGE), "--base", "create2"]
    device = ["--device", str(folder / "create")]
    program = subprocess.Popen([*argv, *device, *arguments], stdin=theirs, stdout=theirs, stderr=theirs)
    os.close(theirs)
    printed, typed, begun = "", 0, time.monotonic()
    try:
        while program.poll() is None or select.select([person], [], [], 0.0)[0]:
            plant.advance(time.monotonic() - begun - plant.time)
            terminal.write(firmware.receive(terminal.read()) + firmware.tick())
            if select.select([person], [], [], 0.01)[0]:
                try:
                    printed += os.read(person, 4096).decode()
                except OSError:
                    break
            if typed < len(keys) and printed.count("?") + printed.count("Press Enter") > typed:
                os.write(person, keys[typed].encode() + b"\n" if keys[typed] != "\n" else b"\n")
                typed += 1
        return program.wait(), printed
    finally:
        program.kill()
        program.wait()
        os.close(person)
        terminal.close()


def test_program_turns_the_wheels_of_a_board_on_its_line_after_a_question(tmp_path: Path) -> None:
    code, printed = answer_in_a_terminal(tmp_path, "y" + "\n\n" * 4)
    assert "ok: the wheels turn and count as the base file says" in printed, printed
    assert code == int("problem: " in printed)  # on a busy computer wheels turn longer than they should


def test_program_names_a_device_that_is_not_there_and_needs_a_terminal(tmp_path: Path) -> None:
    argv = [sys.executable, "-m", "ur_nodes.drivers.wheels.program", "--package", str(PACKAGE), "--base", "create2"]
    done = subprocess.run(argv, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert "no terminal, expected a person who sees the wheels" in done.stderr
    with pytest.raises(UserError, match="cannot be opened"):
        main([*argv[3:], "--device", str(tmp_path / "away")], lambda _: "n", lambda _: None)
    with pytest.raises(UserError, match="no driver of this project"):
        main(["--package", str(PACKAGE), "--base", "stage"], lambda _: "n", lambda _: None)
