"""Commands of a pipe to a robot on a bus."""

import os
import signal
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.ur_nodes.teleop.fake_robot import FakeRobot
from tests.ur_nodes.teleop.recordings import SAVED, serve_recordings

from ur_nodes.client.navigation import Names
from ur_nodes.client.navigator import RobotNavigator
from ur_nodes.client.saving import MapSaving, save_recordings
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result
from ur_nodes.teleop.navigate.batch import BatchTimeouts
from ur_nodes.teleop.navigate.command_line import StoreChoice, name_growing_map
from ur_nodes.teleop.navigate.line_program import run_lines

LIMITS = BatchTimeouts(start=60.0, goal=600.0)


@pytest.fixture(autouse=True)
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    return tmp_path


class LineProgram:
    """The program beside a bus, which runs faster than real time."""

    def __init__(self, *, robot: bool = True, map_name: str = "test", save_service: str = "") -> None:
        self.bus = Bus()
        self.node = self.bus.node("keyboard_navigate")
        if robot:
            self.robot = FakeRobot(self.bus.node("fake_robot"))
        self.navigator = RobotNavigator(self.node, Names(), "keyboard_navigate")
        growing = name_growing_map(self.node, save_service) if save_service else None
        self.saving = MapSaving(self.node, save_service) if save_service else None
        self.stores = StoreChoice("", map_name, growing)
        self.ended = threading.Event()

    def run(
        self,
        text: str,
        *,
        limits: BatchTimeouts = LIMITS,
        attended: bool = False,
        until: Callable[[], bool] = lambda: False,
    ) -> int:
        """The exit code; `ended` is set once `until` is true."""
        source, sink = os.pipe()
        os.write(sink, text.encode())
        os.close(sink)
        codes: list[int] = []

        def run() -> None:
            codes.append(
                run_lines(
                    *("keyboard_navigate", self.navigator, self.stores, limits),
                    *(save_recordings(self.node), self.saving, self.ended, self.node.steady),
                    attended=attended,
                    source=source,
                )
            )

        thread = threading.Thread(target=run)
        thread.start()
        while thread.is_alive():
            self.bus.run(0.02)
            if until():
                self.ended.set()
            thread.join(0.001)
        os.close(source)
        return codes[0]


def test_goals_are_driven_one_after_the_other_and_reported(capsys: pytest.CaptureFixture[str], data: Path) -> None:
    program = LineProgram()
    assert program.run("g 2 3 90\nw corner\ng 0 0 0\nm corner\n") == 0
    shown = capsys.readouterr()
    assert shown.err == ""
    lines = shown.out.splitlines()
    assert lines[0].startswith("g 2 3 90: reached, 0.0")
    assert lines[1] == "w corner: saved at 2.00 3.00 90"
    assert lines[3].startswith("m corner: reached")
    assert (data / "ubiquity_launches/waypoints/test.yaml").is_file()
    assert (program.robot.pose.x, program.robot.pose.y) == (2.0, 3.0)


def test_what_happened_is_saved_where_there_is_a_black_box(capsys: pytest.CaptureFixture[str]) -> None:
    program = LineProgram()
    serve_recordings(program.bus)
    assert program.run("n\n") == 0
    assert capsys.readouterr().out == f"n: {SAVED}\n"
    assert LineProgram().run("n\n") == 1
    assert "what happened was not saved: no service /black_box/write" in capsys.readouterr().out


def test_failed_goal_and_malformed_line_exit_with_1(capsys: pytest.CaptureFixture[str]) -> None:
    assert LineProgram().run("g 2 x\ng 90 90\ng 1 1\n") == 1
    shown = capsys.readouterr()
    assert shown.err == "error: g 2 x: 'x' is not a number, expected: g X Y [ANGLE]\n"
    failed, reached = shown.out.splitlines()
    assert failed.startswith("g 90 90: failed after")
    assert failed.endswith(": the goal is off the map")
    assert reached.startswith("g 1 1: reached")


def test_missing_parts_are_named_after_the_limit(capsys: pytest.CaptureFixture[str]) -> None:
    assert LineProgram(robot=False).run("g 1 1\n", limits=BatchTimeouts(start=0.2, goal=600.0)) == 2
    first = "the map (topic /map) and the robot's pose (tf map -> base_footprint) and navigation (action /move_base)"
    missing = f"{first} and the lease of the mux (topic /cmd_vel_mux/lease)"
    assert f"still waiting for {missing} after 0.2 s" in capsys.readouterr().err


def test_signal_before_the_robot_is_ready_ends_the_program(capsys: pytest.CaptureFixture[str]) -> None:
    program = LineProgram(robot=False)
    assert program.run("g 1 1\n", until=lambda: True) == 128 + signal.SIGINT
    assert capsys.readouterr() == ("", "")


def test_signal_while_a_goal_is_driven_cancels_it(capsys: pytest.CaptureFixture[str]) -> None:
    program = LineProgram()
    assert program.run("g 4.5 4.5\n", until=lambda: program.robot.pose.x > 1.0) == 1
    assert capsys.readouterr().err.endswith("error: keyboard_navigate: interrupted, the goal was cancelled\n")
    assert program.robot.pose.x < 4.0


def test_typed_stop_does_not_wait_for_the_goal(capsys: pytest.CaptureFixture[str]) -> None:
    assert LineProgram().run("foo\ng 4 4\nc\nx\n", attended=True) == 1
    shown = capsys.readouterr()
    assert "one command a line" in shown.out
    assert "g 4 4: stopped after" in shown.out
    assert "unknown command 'foo'" in shown.err


def test_map_that_is_being_made_gets_its_name_and_is_saved(capsys: pytest.CaptureFixture[str], data: Path) -> None:
    program = LineProgram(map_name="", save_service="save")
    answers = [Result(False, "the map is empty"), Result(True, "flat")]
    program.bus.node("slam").serve("save", Trigger, lambda _: answers.pop(0) if len(answers) > 1 else answers[0])
    assert program.run("w here\nsave\n") == 0
    assert capsys.readouterr().out.splitlines()[1] == "save: map 'flat' saved"
    assert (data / "ubiquity_launches/waypoints/flat.yaml").is_file()


def test_map_without_a_name_is_waited_for_until_a_signal() -> None:
    program = LineProgram(map_name="", save_service="save")
    assert program.run("w here\n", until=lambda: program.bus.now > 5_000_000_000) == 128 + signal.SIGINT
