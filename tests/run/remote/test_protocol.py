import json
from dataclasses import asdict
from typing import Any

import pytest

from ur.run.remote.protocol import Client, Problem, ShareAnswer, ShareRequest, dump, parse_answer, parse_request

CLIENT = Client("a1b2", "laptop", "m1", 77, ("/keys",))
REQUEST = ShareRequest(
    "begin", "bob", ("chat", "chat.launch", "text:=a  b\n"), ("--only", "/talk"), ("/talk",), "http://bob.local:11311",
    "bob.local", CLIENT, ("a1b2",),
)  # fmt: skip


def test_requests_and_answers_are_read_as_they_were_written() -> None:
    assert parse_request(dump(REQUEST)) == REQUEST
    answer = ShareAnswer(
        "chat.7",
        found=True,
        running=("/a",),
        clients=("laptop2",),
        names={"/a": "/b"},
        problem=Problem("ü", "h", "r", "p"),
    )
    assert parse_answer(dump(answer)) == answer
    assert parse_answer("{}") == ShareAnswer()


@pytest.mark.parametrize(
    "text",
    ["[]", '{"run": 1}', "Welcome", '{"running": "/a"}', '{"problem": []}', '{"names": {"/a": "b"}}', "x" * 300_000],
)
def test_answer_that_is_none_is_refused(text: str) -> None:
    with pytest.raises((ValueError, TypeError)):
        parse_answer(text)


@pytest.mark.parametrize(
    "change",
    [
        {"action": "stop"},
        {"machine": 1},
        {"machine": "b\x1bob"},
        {"words": "chat"},
        {"words": ["a\0b"]},
        {"words": ["x"] * 600},
        {"nodes": ["talk"]},
        {"nodes": ["/a b"]},
        {"alive": ["../../etc"]},
        {"client": "a1b2"},
        {"client": {**asdict(CLIENT), "client": "../x"}},
        {"client": {**asdict(CLIENT), "client": ""}},
        {"client": {**asdict(CLIENT), "name": "lap\ntop"}},
        {"client": {**asdict(CLIENT), "pid": -1}},
        {"client": {**asdict(CLIENT), "pid": True}},
        {"client": {**asdict(CLIENT), "since": "x"}},
        {"client": {**asdict(CLIENT), "detached": 1}},
        {"client": {"client": "a1b2"}},
    ],
)
def test_request_that_makes_no_sense_is_refused(change: dict[str, Any]) -> None:
    with pytest.raises((ValueError, TypeError)):
        parse_request(json.dumps({**asdict(REQUEST), **change}))


def test_line_of_an_answer_cannot_move_the_cursor() -> None:
    assert parse_answer('{"run": "x\\u001b[2J"}').run == "x [2J"
