"""Which launch file a robot is told to start, and with which arguments."""

import base64
import subprocess
import sys
from pathlib import Path

import pytest

from ur.robot.boot.launch_file import choose_arguments, find_launch, is_launch_name
from ur.robot.ssh.shell import ShellResult
from ur.source import UserError

FACTS = {"base": "magni", "variant": "lidar"}


class FakeShell:
    destination = "bob"

    def __init__(self, *answers: ShellResult) -> None:
        self.answers = list(answers)

    def run(self, *_: object, **__: object) -> ShellResult:
        return self.answers.pop(0)


def test_launch_file_is_read_as_the_robot_has_it() -> None:
    text = base64.b64encode(b"<launch/>").decode()
    shell = FakeShell(
        ShellResult(0, f"noise of a profile\n/there/f.launch\n{text}\n", ""), ShellResult(0, "base: magni\n", "")
    )
    found = find_launch(shell, "p", "f.launch", "bob")
    assert (found.path, found.data, found.robot_file) == ("/there/f.launch", b"<launch/>", "base: magni\n")


@pytest.mark.parametrize(("code", "said"), [(3, "package 'p' is not there"), (4, "no file 'f.launch'"), (1, "why")])
def test_launch_file_that_the_robot_lacks_is_named(code: int, said: str) -> None:
    with pytest.raises(UserError, match=said):
        find_launch(FakeShell(ShellResult(code, "", "why\n")), "p", "f.launch", "bob")


@pytest.mark.parametrize(
    ("declared", "given", "arguments"),
    [
        ({}, {}, {}),
        ({"robot_base": True, "robot_variant": False}, {}, {"robot_base": "magni", "robot_variant": "lidar"}),
        ({"robot_base": True, "robot_variant": False}, {"robot_base": "loki"}, {"robot_base": "loki"}),
        ({"simulate": False, "use_rviz": False}, {}, {"simulate": "false", "use_rviz": "false"}),
        ({"simulate": False}, {"simulate": "true"}, {"simulate": "true"}),
        ({"words": False}, {"words": "a b"}, {"words": "a b"}),
    ],
)
def test_robot_knows_its_own_arguments(
    declared: dict[str, bool], given: dict[str, str], arguments: dict[str, str]
) -> None:
    assert choose_arguments(declared, given, FACTS, "f.launch") == arguments


def test_robot_with_ros2_knows_more_of_itself_than_its_base() -> None:
    declared = {"robot_base": True, "cmd_vel": False, "start_drivers": False}
    more = {"cmd_vel": "/robot1/cmd_vel", "start_drivers": "false", "other": "1"}
    values = choose_arguments(declared, {"start_drivers": "true"}, FACTS, "f.launch", more)
    assert values == {"robot_base": "magni", "cmd_vel": "/robot1/cmd_vel", "start_drivers": "true"}


def test_launch_file_of_a_robot_with_ros2_is_looked_up_among_its_packages(tmp_path: Path) -> None:
    package = tmp_path / "other/p"
    (package / "launch").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>p</name></package>")
    (package / "launch/f.launch").write_text("<launch/>")
    python = tmp_path / "ubiquity_launches/.venv/bin/python"
    python.parent.mkdir(parents=True)
    python.write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    python.chmod(0o755)
    environment = {"HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}
    (tmp_path / "ubiquity_launches/.venv/ready-run").touch()

    class ComputerShell:
        destination = "bob"

        def run(self, script: str, **_: object) -> ShellResult:
            done = subprocess.run(["bash", "-c", script], env=environment, capture_output=True, text=True, check=False)
            return ShellResult(done.returncode, done.stdout, done.stderr)

    setting = f"export ROS_PACKAGE_PATH={tmp_path / 'other'}"
    assert find_launch(ComputerShell(), "p", "f.launch", "bob", setting).data == b"<launch/>"
    with pytest.raises(UserError, match="package 'q' is not there"):
        find_launch(ComputerShell(), "q", "f.launch", "bob", setting)
    with pytest.raises(UserError, match="no file 'g\\.launch'"):
        find_launch(ComputerShell(), "p", "g.launch", "bob", setting)


@pytest.mark.parametrize(
    ("declared", "given", "said"),
    [
        ({"speed": True}, {}, "needs a value for speed"),
        ({"speed": False}, {"sped": "1"}, "no argument 'sped'"),
    ],
)
def test_wrong_arguments_are_named(declared: dict[str, bool], given: dict[str, str], said: str) -> None:
    with pytest.raises(UserError, match=said):
        choose_arguments(declared, given, {}, "f.launch")


@pytest.mark.parametrize(
    ("word", "good"), [("a.launch", True), ("a.launch.xml", True), ("a/b.launch", False), ("launch", False)]
)
def test_launch_names_end_in_launch(word: str, good: bool) -> None:
    assert is_launch_name(word) is good
