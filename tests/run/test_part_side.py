from __future__ import annotations

import json
from dataclasses import asdict, replace

import pytest

from ur.run.part_side import Answer, Request, is_marked, launch_words, parse_answer, parse_request

REQUEST = Request("begin", "bob", ("chat", "chat.launch", "text:=a  b"), ("--only", "/talk"), ("/talk",))
PYTHON = ["/home/ros/ubiquity_launches/.venv/bin/python", "-m", "ur"]


def test_run_is_known_by_the_words_that_started_it() -> None:
    assert is_marked([*PYTHON, *launch_words(REQUEST, [])], REQUEST)
    assert is_marked([*PYTHON, *launch_words(REQUEST, ["/other"])], replace(REQUEST, action="end"))


@pytest.mark.parametrize(
    "other",
    [
        replace(REQUEST, words=("chat", "chat.launch", "text:=a b")),
        replace(REQUEST, words=("chat.launch", "text:=a  b")),
        replace(REQUEST, machine="eve"),
        replace(REQUEST, options=()),
    ],
)
def test_run_of_another_program_is_not_taken_for_it(other: Request) -> None:
    assert not is_marked([*PYTHON, *launch_words(other, [])], REQUEST)


def test_nodes_that_run_already_are_named_before_the_mark() -> None:
    words = launch_words(REQUEST, ["/a", "/b"])
    assert words[:7] == ["launch", "--plain", "--detach", "--runs-already", "/a", "--runs-already", "/b"]
    assert words[7:] == ["--part", "bob", "--only", "/talk", "--", "chat", "chat.launch", "text:=a  b"]


def test_requests_and_answers_survive_the_way() -> None:
    assert parse_request(json.dumps(asdict(REQUEST))) == REQUEST
    answer = Answer("chat.7", found=True, running=("/a",), problem="ü")
    assert parse_answer(json.dumps(asdict(answer))) == answer
    for text in ("[]", '{"ran": 1}', "Welcome"):
        with pytest.raises((ValueError, TypeError)):
            parse_answer(text)
