import json
from typing import Any

import pytest

from ur.web.wire.reading import BadRequestError
from ur.web.wire.run_requests import ChangeNode, EndRun, Envelope, StartProgram, read_run_request

START: dict[str, Any] = {"t": "start", "n": 1, "id": 2, "program": "make_map", "arguments": {"world": "office"}}
NODE: dict[str, Any] = {"t": "node", "n": 1, "id": 2, "run": "demo.7", "node": "/a/b", "do": "restart"}


def test_requests_are_read() -> None:
    assert read_run_request(json.dumps(START)) == Envelope(1, 2, StartProgram("make_map", {"world": "office"}))
    assert read_run_request(json.dumps(NODE)) == Envelope(1, 2, ChangeNode("demo.7", "/a/b", "restart"))
    assert read_run_request('{"t": "end", "n": 0, "id": 0, "run": "demo.7"}') == Envelope(0, 0, EndRun("demo.7"))


@pytest.mark.parametrize(
    "change",
    [
        {"program": "--detach"},
        {"program": "../x"},
        {"program": "a/b/c"},
        {"program": "a\n"},
        {"arguments": []},
        {"arguments": {"--prefix": "x"}},
        {"arguments": {"a:=b": "x"}},
        {"arguments": {"world": 3}},
        {"arguments": {"world": "a\nb"}},
        {"arguments": {"world": "\x1b[2J"}},
        {"arguments": {"world": "$(eval 1)"}},
        {"arguments": {"world": "x" * 257}},
        {"arguments": {f"a{number}": "" for number in range(61)}},
        {"n": -1},
        {"n": True},
        {"n": 2**32},
        {"id": "1"},
        {"t": "kill"},
        {"t": ["start"]},
    ],
)
def test_malformed_starts_are_refused(change: dict[str, Any]) -> None:
    with pytest.raises(BadRequestError):
        read_run_request(json.dumps({**START, **change}))


@pytest.mark.parametrize(
    "change",
    [{"run": "../x.7"}, {"run": "x"}, {"node": "talk"}, {"node": "/a b"}, {"node": "/" + "a" * 300}, {"do": "kill"}],
)
def test_malformed_changes_of_nodes_are_refused(change: dict[str, Any]) -> None:
    with pytest.raises(BadRequestError):
        read_run_request(json.dumps({**NODE, **change}))


@pytest.mark.parametrize("text", [None, b"{}", "", "[]", "[" * 5000, "{" * 20000, '{"t": "start"}'])
def test_what_is_no_request_is_refused(text: object) -> None:
    with pytest.raises(BadRequestError):
        read_run_request(text)
