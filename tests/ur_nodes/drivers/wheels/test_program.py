"""The program of `ur robot wheels` in this process: what it asks, prints and writes, and each way to stop it."""

import io
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.base_contract import PACKAGE, load
from tests.ur_nodes.drivers.pipes import fill_pipe
from tests.ur_nodes.drivers.wheels.wired_board import WiredBoard

from ur.robot.base import load_base
from ur.robot.base.wiring import Wiring
from ur.source.diagnostic import UserError
from ur_nodes.drivers.registry import BOARDS
from ur_nodes.drivers.wheels.program import GuardedLine, main, report, run
from ur_nodes.drivers.wheels.verdict import WheelVerdict

FILE = PACKAGE / "bases" / "create2" / "base.yaml"
RIGHT = "y\n" + "\n\n" * 4  # agrees, presses Enter, and saw each motion as expected
SWAPPED = "y\n" + "\n\n" * 2 + "\nn\nf\nb\n" + "\nno\nback\nforward\n"  # the answers where the motors are swapped

MakeBoard = Callable[..., WiredBoard]


class TerminalText(io.StringIO):
    """Keys that were typed in a terminal."""

    def isatty(self) -> bool:
        return True


class InterruptedText(TerminalText):
    """A terminal in which Ctrl+C is pressed at a question."""

    def readline(self, *_: object) -> str:  # type: ignore[override]
        raise KeyboardInterrupt


@pytest.fixture
def make_board(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[MakeBoard]:
    boards: list[WiredBoard] = []

    def make(name: str = "create2", wiring: Wiring | None = None) -> WiredBoard:
        boards.append(WiredBoard(tmp_path / "device", monkeypatch, name, wiring))
        return boards[-1]

    yield make
    for board in boards:
        board.close()


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package of the user's with the base create2."""
    folder = tmp_path / "package" / "bases" / "create2"
    folder.mkdir(parents=True)
    (folder / "base.yaml").write_text(FILE.read_text())
    return tmp_path / "package"


def run_typed(
    patch: pytest.MonkeyPatch, keys: io.StringIO | str, package: Path, device: Path, base: str = "create2"
) -> int:
    """Run the program with keys as its input."""
    arguments = ["--package", str(package), "--base", base, "--device", str(device)]
    patch.setattr(sys, "argv", ["wheels", *arguments])
    patch.setattr(sys, "stdin", TerminalText(keys) if isinstance(keys, str) else keys)
    return run()


def base_text(package: Path) -> str:
    return (package / "bases" / "create2" / "base.yaml").read_text()


def test_wheels_that_turn_as_the_base_file_says_change_no_file(
    make_board: MakeBoard, package: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    board = make_board()
    assert run_typed(monkeypatch, RIGHT, package, board.path) == 0
    printed = capsys.readouterr().out
    assert printed.startswith(f"{board.path}: ")
    assert printed.count("counted: left ") == 4
    assert "Did the wheels turn so: left forward, right back?" in printed
    assert printed.endswith("ok: the wheels turn and count as the base file says\n")
    assert base_text(package) == FILE.read_text()


def test_motors_that_the_person_saw_swapped_are_written_to_the_base_file(
    make_board: MakeBoard, package: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    board = make_board(wiring=Wiring(motors_swapped=True))
    assert run_typed(monkeypatch, SWAPPED, package, board.path) == 0
    path = package / "bases" / "create2" / "base.yaml"
    assert f"motors swapped: written to {path}; the driver takes it at its next start" in capsys.readouterr().out
    driver = load_base(package, "create2").driver
    assert driver
    assert driver.wiring == Wiring(motors_swapped=True)


def test_guard_is_told_of_motion_and_the_board_is_stopped_and_left_at_the_end(
    make_board: MakeBoard, package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    board = make_board()
    protocol = BOARDS["create2"](load("create2", ""))
    end = protocol.stop() + protocol.shutdown()
    assert run_typed(monkeypatch, RIGHT, package, board.path) == 0
    assert board.guards == [(protocol.stop(), protocol.shutdown())]
    told = board.guard_bytes()
    assert told.startswith(b"r" * 10)
    assert told.endswith(b"r" * 10)
    assert told.count(b"mr") == 4
    assert board.receives(end)


@pytest.mark.parametrize("answer", ["n", "", "no", "x", "yess"])
def test_no_wheel_turns_after_an_answer_that_is_not_yes(
    answer: str,
    make_board: MakeBoard,
    package: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    board = make_board()
    assert run_typed(monkeypatch, f"{answer}\n", package, board.path) == 1
    assert capsys.readouterr().out.endswith("nothing was turned\n")
    assert board.plant.last == (0, 0)
    assert b"m" not in board.guard_bytes()


@pytest.mark.parametrize("keys", ["", "y\n", "y\n\n", "y\n\n\n\n", "y\n\nn\nf\n"])
def test_end_of_input_at_any_question_stops_the_board_and_changes_nothing(
    keys: str,
    make_board: MakeBoard,
    package: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    board = make_board(wiring=Wiring(motors_swapped=True))
    end = BOARDS["create2"](load("create2", "")).shutdown()
    assert run_typed(monkeypatch, keys, package, board.path) == 130
    assert capsys.readouterr().err == "\nstopped; nothing was changed\n"
    assert base_text(package) == FILE.read_text()
    assert board.guard_bytes().endswith(b"r")
    assert board.receives(end)


def test_ctrl_c_at_the_first_question_ends_it_before_a_wheel_turns(
    make_board: MakeBoard, package: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    board = make_board()
    assert run_typed(monkeypatch, InterruptedText(), package, board.path) == 130
    assert capsys.readouterr().err == "\nstopped; nothing was changed\n"
    assert board.plant.last == (0, 0)


def test_third_direction_that_is_none_ends_the_test(
    make_board: MakeBoard, package: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    board = make_board()
    assert run_typed(monkeypatch, "y\n\nn\nup\n\n?\n", package, board.path) == 2
    captured = capsys.readouterr()
    assert captured.out.count("the robot's left wheel turn") == 3
    assert "no answer, expected f, b or n; nothing was changed" in captured.err
    assert base_text(package) == FILE.read_text()


def test_direction_is_asked_again_after_an_answer_that_is_none(
    make_board: MakeBoard, package: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    board = make_board()
    keys = "y\n\nn\nup\nN\nf\n" + "\n\n" * 3
    assert run_typed(monkeypatch, keys, package, board.path) == 1
    assert "problem: the left wheel did not turn: check its motor" in capsys.readouterr().out


def test_silent_board_is_reported_after_its_time(
    make_board: MakeBoard, package: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    board = make_board()
    board.silent = True
    assert run_typed(monkeypatch, RIGHT, package, board.path) == 2
    captured = capsys.readouterr()
    assert "no wheel counts of iRobot Create 2 or Roomba for 6 s; is it switched on?" in captured.err
    assert captured.out == ""
    assert b"m" not in board.guard_bytes()


def test_board_whose_motors_have_no_power_is_reported(
    make_board: MakeBoard, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    board = make_board("magni")
    board.firmware.power = False
    assert run_typed(monkeypatch, RIGHT, PACKAGE, board.path, "magni") == 2
    assert "does not drive: its motors have no power (emergency stop?)" in capsys.readouterr().err


def test_board_that_is_unplugged_while_a_wheel_turns_ends_the_test(
    make_board: MakeBoard, package: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    board = make_board()
    board.unplugged_by_motion = True
    assert run_typed(monkeypatch, RIGHT, package, board.path) == 2
    captured = capsys.readouterr()
    assert f"{board.path} was unplugged, expected iRobot Create 2 or Roomba" in captured.err
    assert "counted:" not in captured.out
    assert b"m" in board.guard_bytes()


def test_board_that_is_unplugged_at_a_question_ends_the_test(make_board: MakeBoard, package: Path) -> None:
    board, asked = make_board(), list[str]()

    def ask(question: str) -> str:
        asked.append(question)
        if "Press Enter" in question:
            board.unplug()
        return "y"

    argv = ["--package", str(package), "--base", "create2", "--device", str(board.path)]
    with pytest.raises(UserError, match="was unplugged, expected iRobot Create 2 or Roomba"):
        main(argv, ask, asked.append)
    assert asked[-1] == "Press Enter, and watch the wheels: forward "


def test_bytes_reach_the_board_while_the_pipe_of_its_guard_is_full(make_board: MakeBoard) -> None:
    board = make_board()
    with GuardedLine(str(board.path), BOARDS["create2"](load("create2", "")), 0) as line:
        full = fill_pipe(line._guard._pipe)
        line.exchange(b"speeds", 0.0, moving=True)
        assert board.receives(b"speeds")
    assert board.guard_bytes() == bytes(full)


def test_guard_that_is_killed_while_a_wheel_turns_is_started_again_and_the_test_goes_on(
    make_board: MakeBoard, package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    board = make_board()
    board.kills_guard_by_motion = True
    assert run_typed(monkeypatch, RIGHT, package, board.path) == 0
    assert len(board.guards) == 2
    assert board.guard_bytes().startswith(b"m")


def test_input_that_is_no_terminal_is_refused_before_the_device_is_opened(
    make_board: MakeBoard, package: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    board = make_board()
    assert run_typed(monkeypatch, io.StringIO(RIGHT), package, board.path) == 2
    assert "no terminal, expected a person who sees the wheels" in capsys.readouterr().err
    assert board.guards == []


@pytest.mark.parametrize(
    ("base", "problem"), [("stage", "base 'stage' has no driver of this project"), ("creat2", "creat2")]
)
def test_base_without_a_board_of_this_project_is_refused_before_the_device_is_opened(
    base: str,
    problem: str,
    make_board: MakeBoard,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    board = make_board()
    assert run_typed(monkeypatch, RIGHT, PACKAGE, board.path, base) == 2
    assert problem in capsys.readouterr().err
    assert board.guards == []


def test_device_that_cannot_be_opened_is_named_with_the_board_that_was_expected(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_typed(monkeypatch, RIGHT, package, tmp_path / "away") == 2
    printed = capsys.readouterr().err
    assert "cannot be opened (no such file or directory), expected iRobot Create 2 or Roomba" in printed
    assert "stop the robot's programs (ur stop, ur boot)" in printed


def test_problems_without_a_wiring_are_printed_and_write_nothing(package: Path) -> None:
    lines: list[str] = []
    path = package / "bases" / "create2" / "base.yaml"
    assert report(WheelVerdict(None, ("one", "two")), path, load("create2", ""), lines.append) == 1
    assert lines == ["problem: one", "problem: two"]
    assert base_text(package) == FILE.read_text()


def test_base_file_that_cannot_be_written_is_reported_with_what_to_add(tmp_path: Path) -> None:
    path = tmp_path / "base.yaml"
    path.write_text("name: without a driver\n")
    wiring = Wiring(motors_swapped=True, left_counter_reversed=True)
    with pytest.raises(UserError, match=r"motors swapped, left counter reversed; .* cannot be written") as raised:
        report(WheelVerdict(wiring), path, load("create2", ""), lambda _: None)
    assert "wiring: {motors_swapped: true, left_counter_reversed: true}" in str(raised.value.diagnostics[0].help)
    assert path.read_text() == "name: without a driver\n"
