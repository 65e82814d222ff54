"""Programs of the library that join a robot that runs already."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT, make_environment
from tests.ros2_session import PYTHON, free_domain

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]


class UrShell:
    """`ur` in an environment of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.environment = make_environment(folder)
        self.environment["PATH"] = f"{ROOT / 'ubiquity_launches' / 'bin'}:{os.environ['PATH']}"

    def ur(self, *words: str, keys: str = "") -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [str(ROOT / "ur"), *words],
            env=self.environment,
            cwd=self.folder,
            input=keys,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )


@pytest.fixture
def shell(tmp_path: Path) -> Iterator[UrShell]:
    made = UrShell(tmp_path)
    yield made
    assert made.ur("stop", "--all").returncode == 0


@pytest.fixture(params=["1", pytest.param("2", marks=pytest.mark.long)])
def shell_of_either(request: pytest.FixtureRequest, shell: UrShell) -> UrShell:
    if request.param == "2":
        if not PYTHON.exists():
            pytest.skip("no wheels of ROS 2 for this processor")
        shell.environment["ROS_DOMAIN_ID"] = free_domain()
        shell.environment["XDG_RUNTIME_DIR"] = str(shell.folder)
        assert shell.ur("use", "sim", "--ros", "2").returncode == 0
    return shell


def start_robot(shell: UrShell, *arguments: str) -> str:
    words = ("--detach", "--wait", "--timeout-ready", "200", *arguments)
    done = shell.ur("run", "robot_base", *words)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_navigation_joins_the_robot_in_its_world_and_leaves_it_running(shell_of_either: UrShell) -> None:
    shell = shell_of_either
    run = start_robot(shell, "world:=office")
    for _ in range(2):
        done = shell.ur("run", "keyboard_navigate", keys="g 1 0 0\n")
        assert f"joining the robot that {run} started\n" in done.stderr
        assert "simulator" not in done.stderr
        assert done.returncode == 0, done.stdout + done.stderr
        assert done.stdout.startswith("g 1 0 0: reached, ")
    [line] = shell.ur("ps").stdout.splitlines()[1:]
    assert line.startswith(run)


@pytest.mark.parametrize(
    ("argument", "present"),
    [
        ("world:=maze", "/simulator/world_file 'office.yaml'"),
        ("robot_base:=magni", "robot_base 'stage'"),
    ],
)
def test_argument_that_the_running_robot_contradicts_is_refused(shell: UrShell, argument: str, present: str) -> None:
    run = start_robot(shell, "world:=office")
    done = shell.ur("run", "keyboard_drive", argument)
    assert done.returncode == 1
    assert f"error: {argument!r} is not possible: the robot that {run} started has {present}" in done.stderr
    assert f"'ur stop {run}' ends that robot" in done.stderr
    assert "bring_up:=false" in done.stderr
    assert len(shell.ur("ps").stdout.splitlines()) == 2
