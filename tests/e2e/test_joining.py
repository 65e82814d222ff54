"""Programs of the library that join a robot that runs already."""

import pytest
from tests.e2e.conftest import UrShell

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]


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
def test_argument_that_the_running_robot_contradicts_is_refused(
    shell_of_either: UrShell, argument: str, present: str
) -> None:
    shell = shell_of_either
    run = start_robot(shell, "world:=office")
    done = shell.ur("run", "keyboard_drive", argument)
    assert done.returncode == 1
    assert f"error: {argument!r} is not possible: the robot that {run} started has {present}" in done.stderr
    assert f"'ur stop {run}' ends that robot" in done.stderr
    assert "bring_up:=false" in done.stderr
    assert len(shell.ur("ps").stdout.splitlines()) == 2


def test_mapping_is_not_started_beside_localisation(shell_of_either: UrShell) -> None:
    shell = shell_of_either
    done = shell.ur("run", "keyboard_navigate", "--no-terminal", "--detach", "--wait", "--timeout-ready", "200")
    assert done.returncode == 0, done.stderr
    run = done.stdout.strip()
    done = shell.ur("run", "make_map", "--no-terminal", "map:=beside")
    assert done.returncode == 1
    assert f"error: amcl of {run} publishes map -> odom already, and so would slam_gmapping" in done.stderr
    assert f"'ur stop {run}' ends it" in done.stderr
    assert len(shell.ur("ps").stdout.splitlines()) == 2
