import os
from pathlib import Path

import pytest

from ur.launchfile.world import MemoryWorld
from ur.request.launch_request import LaunchFiles, LaunchOptions, LaunchRequest
from ur.request.remote.on_robot import (
    choose_options,
    describe_end,
    describe_part,
    explain_problem,
    find_new_name,
    name_file,
)
from ur.robot.discovery.record import RobotRecord, records_folder, render_record
from ur.robot.selection import parse_selection, selection_path, store_selection
from ur.run.remote.protocol import Problem, ShareAnswer
from ur.source import UserError
from ur.source.arguments import Argument


@pytest.mark.parametrize(
    ("answer", "lines"),
    [
        (ShareAnswer("x.1"), ["bob: 3 nodes, run x.1; what they print: ur shell bob ur attach x.1"]),
        (
            ShareAnswer("x.1", found=True),
            ["bob: 3 nodes, run x.1, which ran already and is taken over; what they print: ur shell bob ur attach x.1"],
        ),
        (
            ShareAnswer("x.1", running=("/a", "/b")),
            [
                "bob: 2 nodes run already: /a, /b",
                "bob: 1 node, run x.1; what they print: ur shell bob ur attach x.1",
            ],
        ),
        (ShareAnswer(running=("/a",)), ["bob: 1 node runs already: /a"]),
        (
            ShareAnswer("x.1", found=True, clients=("laptop",)),
            ["bob: 3 nodes, run x.1, which laptop uses too; what they print: ur shell bob ur attach x.1"],
        ),
        (
            ShareAnswer(running=("/a",), clients=("laptop", "desk")),
            ["bob: 1 node runs already: /a", "bob: laptop, desk use these nodes too"],
        ),
        (
            ShareAnswer("x.1", renamed_from="tom"),
            [
                "bob: its nodes ran under its old name tom and are started again",
                "bob: 3 nodes, run x.1; what they print: ur shell bob ur attach x.1",
            ],
        ),
    ],
)
def test_what_runs_on_the_robot_is_told_in_a_line(answer: ShareAnswer, lines: list[str]) -> None:
    assert describe_part("bob", answer, 3) == lines


@pytest.mark.parametrize(
    ("problem", "message", "help_"),
    [
        (Problem("no package x", "install it"), "bob: no package x", "install it"),
        (Problem("chat is neither a package", rule="unknown-package"), "bob: chat is neither", "ur sync bob"),
        (
            Problem("/talk: package 'x' is not installed", "apt install x", "unknown-package", "a.launch:3:5"),
            "bob: a.launch:3:5: /talk: package 'x' is not installed",
            "apt install x",
        ),
        (Problem("run x has not ended", "ur shell bob ur stop x"), "bob: run x", "ur shell bob ur stop x"),
        (Problem("Segmentation fault"), "bob: Segmentation fault", "ur doctor bob"),
    ],
)
def test_problem_of_the_robot_becomes_an_error_that_names_the_robot(problem: Problem, message: str, help_: str) -> None:
    (found,) = explain_problem("bob", problem).diagnostics
    assert found.message.startswith(message)
    assert help_ in (found.help or "")


@pytest.mark.parametrize(
    ("answer", "lines"),
    [
        (ShareAnswer(ended=("x.1",)), ["bob: x.1 has ended"]),
        (ShareAnswer(kept=("x.1",), clients=("laptop2", "desk")), ["bob: x.1 goes on for laptop2, desk"]),
        (ShareAnswer(), []),
    ],
)
def test_end_says_which_runs_go_on_and_for_whom(answer: ShareAnswer, lines: list[str]) -> None:
    assert describe_end("bob", answer) == lines


def test_options_that_choose_nodes_are_handed_on() -> None:
    assert choose_options(LaunchOptions(only=["a", "b"], except_=["c"], screen=True)) == (
        *("--only", "a", "--only", "b"),
        *("--except", "c"),
    )


def test_file_of_a_package_is_named_by_both() -> None:
    files = LaunchFiles(["/ws/chat/launch/chat.launch"], MemoryWorld(files={}))
    request = LaunchRequest(files, (Argument("text", "x"),), names=("chat", "chat.launch"))
    assert name_file(request, "bob") == ["chat", "chat.launch"]


@pytest.mark.parametrize("name", ["/no/package/x.launch", "-"])
def test_file_that_the_robot_cannot_have_is_explained(name: str) -> None:
    with pytest.raises(UserError, match="expected a launch file of a package, which bob has too"):
        name_file(LaunchRequest(LaunchFiles([name], MemoryWorld(files={})), names=(name,)), "bob")


@pytest.mark.parametrize(
    ("selected", "known", "name"),
    [
        ("bob", ("bob",), "bob"),
        ("eve", ("eve",), "eve"),
        ("eve", ("bob", "eve"), "bob"),
        ("sim", ("tom",), "bob"),
    ],
)
def test_robot_that_was_renamed_from_this_computer_is_found_by_its_new_name(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, selected: str, known: tuple[str, ...], name: str
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    for each in known:
        path = records_folder(os.environ) / f"{each}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(render_record(RobotRecord(each, "ros", "magni")))
    store_selection(selection_path(os.environ), parse_selection(selected))
    assert find_new_name("bob") == name
