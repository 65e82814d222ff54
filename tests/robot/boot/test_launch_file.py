"""Which launch file a robot is told to start, and with which arguments."""

from __future__ import annotations

import base64

import pytest

from ur.robot.boot.launch_file import choose_arguments, find_launch, is_launch_name
from ur.robot.ssh.shell import ShellResult
from ur.source import UserError

FACTS = {"base": "magni", "variant": "lidar"}


class FakeShell:
    place = "bob"

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
