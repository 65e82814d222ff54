"""The scripts of docs/how-to/write-a-script.md, as they are written there, on a bus with a simulated robot."""

import re
from functools import partial
from pathlib import Path

import pytest
from tests.ur_nodes.first_drive.drive import FirstDrive

import ur_nodes.client
from ur_nodes.client.script.robot import Robot

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "how-to" / "write-a-script.md").read_text(encoding="utf-8")
SCRIPTS = dict(re.findall(r"^```python (\S+)\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE))


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> FirstDrive:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    stage = FirstDrive()
    robot = partial(Robot, "script", node=stage.bus.node("script"), wait=stage.bus.run_until)
    monkeypatch.setattr(ur_nodes.client, "Robot", robot, raising=False)
    return stage


def run(name: str, capsys: pytest.CaptureFixture[str]) -> str:
    """What a script prints."""
    exec(compile(SCRIPTS[name], name, "exec"), {"__name__": "__main__"})
    return capsys.readouterr().out


def test_robot_goes_there(stage: FirstDrive, capsys: pytest.CaptureFixture[str]) -> None:
    start = stage.truth.pose
    assert re.fullmatch(r"the robot is at -?\d+\.\d\d -?\d+\.\d\d\n", run("go_there.py", capsys))
    assert abs(stage.truth.pose.x - start.x - 0.5) < 0.3


def test_robot_stops_before_what_is_near(stage: FirstDrive, capsys: pytest.CaptureFixture[str]) -> None:
    distance = float(re.fullmatch(r"something is (\S+) m ahead\n", run("until_near.py", capsys))[1])  # type: ignore[index]
    assert 0.2 < distance < 0.65
    stage.bus.run(0.6)
    assert abs(stage.truth.twist.forward) < 0.01


def test_robot_follows_the_file(stage: FirstDrive, capsys: pytest.CaptureFixture[str]) -> None:
    here = stage.truth.pose
    Path("places.csv").write_text(f"{here.x + 0.4:.2f},{here.y:.2f}\n1000,1000\n")
    first, second = run("follow_file.py", capsys).splitlines()
    assert first.endswith(": reached")
    assert second.startswith("1000 1000: ")
    assert not second.endswith("reached")
