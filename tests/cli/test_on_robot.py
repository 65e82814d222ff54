from __future__ import annotations

import pytest

from ur.cli.launch_wishes import Wishes
from ur.cli.on_robot import choose_options, describe_part, explain_problem, name_file
from ur.launchfile.world import MemoryWorld
from ur.run.part_side import Answer
from ur.source import UserError


@pytest.mark.parametrize(
    ("answer", "lines"),
    [
        (Answer("x.1"), ["bob: 3 nodes, run x.1; what they print: ur shell bob ur attach x.1"]),
        (
            Answer("x.1", found=True),
            ["bob: 3 nodes, run x.1, which ran already and is taken over; what they print: ur shell bob ur attach x.1"],
        ),
        (
            Answer("x.1", running=("/a", "/b")),
            [
                "bob: 2 nodes run already: /a, /b",
                "bob: 1 node, run x.1; what they print: ur shell bob ur attach x.1",
            ],
        ),
        (Answer(running=("/a",)), ["bob: 1 node runs already: /a"]),
    ],
)
def test_what_runs_on_the_robot_is_told_in_a_line(answer: Answer, lines: list[str]) -> None:
    assert describe_part("bob", answer, 3) == lines


@pytest.mark.parametrize(
    ("said", "message", "help_"),
    [
        ("error: no package x\n  help: install it\n", "bob: no package x", "install it"),
        ("warning: old\nerror: chat is neither a package nor a file, expected", "bob: chat is neither", "ur sync bob"),
        ("Segmentation fault\n", "bob: Segmentation fault", "ur doctor bob"),
    ],
)
def test_what_the_robot_says_becomes_one_line_of_ours(said: str, message: str, help_: str) -> None:
    (found,) = explain_problem("bob", said).diagnostics
    assert found.message.startswith(message)
    assert help_ in (found.help or "")


def test_options_that_choose_nodes_are_handed_on() -> None:
    assert choose_options(Wishes(only=["a", "b"], except_=["c"], screen=True)) == (
        *("--only", "a", "--only", "b"),
        *("--except", "c"),
    )


def test_file_of_a_package_is_named_by_both() -> None:
    words = ["chat", "chat.launch", "text:=x"]
    assert name_file(words, ["/ws/chat/launch/chat.launch"], MemoryWorld(files={}), "bob") == ["chat", "chat.launch"]


@pytest.mark.parametrize("word", ["/no/package/x.launch", "-"])
def test_file_that_the_robot_cannot_have_is_explained(word: str) -> None:
    with pytest.raises(UserError, match="expected a launch file of a package, which bob has too"):
        name_file([word], [word], MemoryWorld(files={}), "bob")
