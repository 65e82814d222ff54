import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.source.foreign.json_values import BadJsonError
from ur_nodes.client.patrol_text import (
    PatrolAnswer,
    PatrolRequest,
    PatrolRoute,
    PatrolStatus,
    PatrolStop,
    describe_patrol,
    read_request,
    read_status,
    write_request,
    write_status,
)

ROUTE = PatrolRoute(
    (PatrolStop("sofa", 1.0, 2.0, 0.5), PatrolStop("", -1.0, 0.0), PatrolStop("hall")), loop=True, wait=2.5
)


@pytest.mark.parametrize(
    "request_",
    [
        PatrolRequest("start", ROUTE, "a-1", "client:1", "phone", (12, 500)),
        PatrolRequest("start", PatrolRoute((PatrolStop("sofa"),))),
        PatrolRequest("pause", id="a-2", client="c", name="laptop", answers=(0, 0)),
        PatrolRequest("end"),
    ],
)
def test_request_survives_json(request_: PatrolRequest) -> None:
    assert read_request(write_request(request_)) == request_


@pytest.mark.parametrize("state", ["idle", "driving", "paused"])
def test_status_survives_json(state: str) -> None:
    status = PatrolStatus(state, ROUTE, 1, 3, "by phone", PatrolAnswer("a-1", "late"))  # type: ignore[arg-type] # of its list
    assert read_status(write_status(status)) == status
    assert read_status(write_status(PatrolStatus())) == PatrolStatus()


def test_script_names_places_in_a_list() -> None:
    assert read_request('{"do": "start", "places": ["sofa", "hall"]}').route == PatrolRoute(
        (PatrolStop("sofa"), PatrolStop("hall"))
    )


@pytest.mark.parametrize(
    "value",
    [
        {},
        {"do": "fly"},
        {"do": "start"},
        {"do": "start", "places": []},
        {"do": "start", "places": ["a"] * 51},
        {"do": "start", "places": [""]},
        {"do": "start", "places": [{"x": 1e9}]},
        {"do": "start", "places": [{"x": True}]},
        {"do": "start", "places": ["a\n"]},
        {"do": "start", "places": ["a"], "wait": -1},
        {"do": "start", "places": ["a"], "loop": 1},
        {"do": "start", "places": ["a"], "client": "c", "answers": [1]},
        {"do": "start", "places": ["a"], "answers": [1, 2], "client": 5},
        {"do": "end", "id": "x" * 65},
    ],
)
def test_malformed_request_is_refused(value: object) -> None:
    with pytest.raises(BadJsonError):
        read_request(json.dumps(value))


VALUES = st.recursive(st.none() | st.booleans() | st.floats() | st.text(), st.lists)


@given(st.text() | VALUES.map(json.dumps))
def test_any_text_is_read_or_refused(text: str) -> None:
    assert read_status(text) is None
    with pytest.raises(BadJsonError):
        read_request(text)


@pytest.mark.parametrize(
    ("status", "line"),
    [
        (PatrolStatus(), ""),
        (PatrolStatus("driving", ROUTE, 1, 2), "patrol: drives to (-1.00, 0.00) (2 of 3, round 3)"),
        (PatrolStatus("waiting", PatrolRoute((PatrolStop("sofa"),))), "patrol: waits at sofa (1 of 1)"),
        (PatrolStatus("paused", ROUTE, reason="by phone"), "patrol paused before sofa (1 of 3, round 1): by phone"),
        (PatrolStatus("ended", reason="by phone"), "patrol ended: by phone"),
        (PatrolStatus("ended"), "patrol ended"),
    ],
)
def test_status_is_described_in_a_line(status: PatrolStatus, line: str) -> None:
    assert describe_patrol(status) == line
