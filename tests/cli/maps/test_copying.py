"""Copies of maps to and from a robot. Its share runs in a real shell here, with maps of its own."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ur.cli.main import main
from ur.cli.maps import copying
from ur.maps.picture_file import write_picture
from ur.robot.ssh.address import Address
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import LocalShell, ShellResult


class RobotShell(LocalShell):
    """Runs the robot's share with maps of its own; `cut` is the number of bytes of a message that arrive."""

    def __init__(self, data: Path) -> None:
        super().__init__()
        self._data = data
        self.cut: int | None = None

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 60.0) -> ShellResult:
        assert isinstance(stdin, str)
        done = super().run(
            f"export XDG_DATA_HOME='{self._data}'; {script}", root=root, stdin=stdin[: self.cut], timeout=timeout
        )
        return replace(done, out=done.out[: self.cut])


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RobotShell:
    """A robot, and the map `flat` here."""
    shell = RobotShell(tmp_path / "robot")

    @contextmanager
    def connect(_address: Address) -> Iterator[RobotShell]:
        yield shell

    monkeypatch.setattr(copying, "connect_robot", connect)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    values = np.random.default_rng(0).choice(np.array((0, 100, -1), np.int8), (40, 60))
    plan = write_picture(tmp_path / "plan", values, 0.1, (0.0, 0.0, 0.0))
    assert main(["maps", "import", str(plan), "flat"]) == 0
    return shell


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != ".lock"}


def maps_of(folder: Path) -> Path:
    return folder / "ubiquity_launches" / "maps"


@pytest.mark.usefixtures("robot")
def test_map_goes_to_the_robot_and_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    here, there = maps_of(tmp_path / "data"), maps_of(tmp_path / "robot")
    assert main(["maps", "copy", "flat", "--to", "bob", "--as", "home"]) == 0
    capsys.readouterr()
    assert main(["maps", "--robot", "bob"]) == 0
    assert capsys.readouterr().out == "home\n"
    assert main(["maps", "copy", "home", "--from", "bob"]) == 0
    assert files(here / "flat") == files(there / "home") == files(here / "home")
    assert sorted(path.name for path in there.iterdir()) == ["home"]


@pytest.mark.parametrize("direction", ["--to", "--from"])
def test_copy_that_is_cut_off_leaves_nothing(direction: str, tmp_path: Path, robot: RobotShell) -> None:
    assert main(["maps", "copy", "flat", "--to", "bob", "--as", "other"]) == 0
    target = maps_of(tmp_path / ("robot" if direction == "--to" else "data"))
    before = sorted(path.name for path in target.iterdir())
    name = "flat" if direction == "--to" else "other"
    for robot.cut in (0, 4, 400, 1001):
        assert main(["maps", "copy", name, direction, "bob", "--as", "new"]) == 2
        assert sorted(path.name for path in target.iterdir()) == before
    robot.cut = None
    assert main(["maps", "copy", name, direction, "bob", "--as", "new"]) == 0


def test_map_that_is_there_or_is_being_made_is_not_replaced(
    tmp_path: Path, robot: RobotShell, capsys: pytest.CaptureFixture[str]
) -> None:
    there = maps_of(tmp_path / "robot")
    assert main(["maps", "copy", "flat", "--to", "bob"]) == 0
    assert main(["maps", "copy", "flat", "--to", "bob"]) == 2
    assert "has a map 'flat' already" in capsys.readouterr().err
    (there / "begun").mkdir()
    with (there / "begun" / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert main(["maps", "copy", "flat", "--to", "bob", "--as", "begun"]) == 2
    assert "is being changed on" in capsys.readouterr().err
    assert sorted(path.name for path in there.iterdir()) == ["begun", "flat"]
    assert robot.cut is None


@pytest.mark.usefixtures("robot")
def test_names_that_could_be_something_else_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("../flat", "-x", "a b", "a;b", "latest", ""):
        for words in ([name, "--from", "bob"], ["flat", "--to", "bob", "--as", name or "$(id)"]):
            assert main(["maps", "copy", *words]) == 2
    assert main(["maps", "copy", "flta", "--from", "bob"]) == 2
    assert "has no map 'flta'" in capsys.readouterr().err
    assert sorted(path.name for path in maps_of(tmp_path / "data").iterdir()) == ["flat"]
