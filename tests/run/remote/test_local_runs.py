from dataclasses import replace

import pytest

from ur.run.remote.local_runs import is_marked
from ur.run.remote.protocol import ShareRequest
from ur.run.remote.start import launch_arguments

REQUEST = ShareRequest("begin", "bob", ("chat", "chat.launch", "text:=a  b"), ("--only", "/talk"), ("/talk",))
PYTHON = ["/home/ros/ubiquity_launches/.venv/bin/python", "-m", "ur"]


def test_run_is_known_by_the_words_that_started_it() -> None:
    assert is_marked([*PYTHON, *launch_arguments(REQUEST, [], "/r")], REQUEST)
    assert is_marked([*PYTHON, *launch_arguments(REQUEST, ["/other"], "/r")], replace(REQUEST, action="end"))


@pytest.mark.parametrize(
    "other",
    [
        replace(REQUEST, words=("chat", "chat.launch", "text:=a b")),
        replace(REQUEST, words=("chat.launch", "text:=a  b")),
        replace(REQUEST, machine="eve"),
        replace(REQUEST, options=()),
    ],
)
def test_run_of_another_program_is_not_taken_for_it(other: ShareRequest) -> None:
    assert not is_marked([*PYTHON, *launch_arguments(other, [], "/r")], REQUEST)


def test_run_is_known_after_the_robot_was_renamed() -> None:
    before = replace(REQUEST, words=(*REQUEST.words, "robot_machine:=bob"))
    after = replace(before, machine="eve", words=(*REQUEST.words, "robot_machine:=eve"))
    command = [*PYTHON, *launch_arguments(before, [], "/r")]
    assert is_marked(command, after, "bob")
    assert not is_marked(command, after, "tom")
    assert not is_marked(command, replace(after, words=(*REQUEST.words, "robot_machine:=tom")), "bob")


def test_nodes_that_run_already_are_named_before_the_mark() -> None:
    words = launch_arguments(REQUEST, ["/a", "/b"], "/r")
    assert words[:5] == ["launch", "--plain", "--detach", "--report", "/r"]
    assert words[5:9] == ["--runs-already", "/a", "--runs-already", "/b"]
    assert words[9:] == ["--part", "bob", "--only", "/talk", "--", "chat", "chat.launch", "text:=a  b"]
