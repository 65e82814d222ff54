"""The examples of docs/examples, as they are, on a bus with a simulated robot."""

from __future__ import annotations

import io
import json
import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from tests.ur_nodes.first_drive.drive import FirstDrive

import ur_nodes.client
from ur_nodes.client.script.robot import Robot

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
PRINTED = {
    "go_and_look": r"(\d+ degrees: (\d+\.\d\d|inf) m\n){4}",
    "patrol_with_pictures": r"table: table.jpeg, \d+ bytes\ndoor: door.jpeg, \d+ bytes\n",
    "dock_search": r"(a gap is ahead after \d+ steps: .*|no gap was found)\n",
    "wall_follower": r"the wall is (\d+\.\d\d|inf) m away\n",
    "measure_a_room": r"\d+\.\d m2 in sight, \d+\.\d m x \d+\.\d m\n",
    "follow_csv": r".*: reached\n1000 1000: .*\n",
    "state_machine": r"(search\n)+advance\ncome_home\n",
    "while_driving": r"(reached|not there after a second: stopped)\n\d\.\d\d m from the start\n",
    "square": r"\d\.\d\d m from the start\n",
}
TWO_ROBOTS = "two_robots"


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> FirstDrive:
    """A robot, and a folder in which `Robot()` is that robot."""
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    stage = FirstDrive()
    given: dict[str, Any] = {"node": stage.bus.node("script"), "wait": stage.bus.run_until}
    library = ModuleType("ur_nodes.client")
    vars(library).update(
        {name: getattr(ur_nodes.client, name) for name in ("Interrupted", "Lost", "Refused", "TakenOver")}
    )
    vars(library).update(Robot=lambda name="script": Robot(name, **given))
    monkeypatch.setitem(sys.modules, "ur_nodes.client", library)
    Path("places.csv").write_text("0.4,0.0\n1000,1000\n")
    return stage


def assert_at_rest(stage: FirstDrive) -> None:
    stage.bus.run(0.6)
    assert abs(stage.truth.twist.forward) < 0.01
    assert abs(stage.truth.twist.turn) < 0.02


@pytest.mark.parametrize("name", sorted(PRINTED))
def test_example_does_what_it_says(stage: FirstDrive, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = (EXAMPLES / f"{name}.py").read_text(encoding="utf-8")
    exec(compile(text, name, "exec"), {"__name__": "__main__"})
    assert re.fullmatch(PRINTED[name], capsys.readouterr().out)
    assert_at_rest(stage)


def test_each_of_two_robots_drives_when_it_is_its_turn(stage: FirstDrive, capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, Any] = {"__name__": TWO_ROBOTS}
    exec((EXAMPLES / f"{TWO_ROBOTS}.py").read_text(encoding="utf-8"), names)
    names["drive"](io.StringIO("go\n"))
    assert re.fullmatch(r"ready\nis at -?\d+\.\d\d -?\d+\.\d\d m\n", capsys.readouterr().out)
    assert_at_rest(stage)


class Plot(ModuleType):
    """The calls of matplotlib that the notebook makes, kept; it is no dependency of this project."""

    def __init__(self) -> None:
        super().__init__("matplotlib.pyplot")
        self.calls: list[str] = []

    def subplots(self, **_options: object) -> tuple[Plot, Plot]:
        return self, self

    def plot(self, x: object, y: object, style: str) -> None:
        assert len(x) == len(y) > 100  # type: ignore[arg-type]
        self.calls.append(f"plot {style}")

    def set_title(self, text: str) -> None:
        self.calls.append(text)

    def savefig(self, name: str) -> None:
        self.calls.append(name)


@pytest.mark.usefixtures("stage")
def test_notebook_plots_the_scan(monkeypatch: pytest.MonkeyPatch) -> None:
    plot = Plot()
    package = ModuleType("matplotlib")
    vars(package)["pyplot"] = plot
    monkeypatch.setitem(sys.modules, "matplotlib", package)
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", plot)
    cells = json.loads((EXAMPLES / "plot_scan.ipynb").read_text(encoding="utf-8"))["cells"]
    names: dict[str, object] = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    assert plot.calls[0] == "plot ."
    assert re.fullmatch(r"the robot is at -?\d\.\d\d -?\d\.\d\d m", plot.calls[1])
    assert plot.calls[2] == "scan.png"


def test_every_example_is_run() -> None:
    assert {each.stem for each in EXAMPLES.glob("*.py")} == {*PRINTED, TWO_ROBOTS}
