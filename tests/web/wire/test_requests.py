import json
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.web.wire.map_requests import ForgetPlace, NamePlace, SaveMap
from ur.web.wire.reading import BadRequestError
from ur.web.wire.requests import (
    LONGEST,
    Alive,
    AskForLease,
    AskPatrol,
    Cancel,
    GoalRequest,
    GoTo,
    LetGo,
    ReleaseAll,
    Stick,
    StopAll,
    SwitchObstacleStop,
    read_request,
)

N = [12, 500]
STICK = {"t": "stick", "n": N, "hold": 1, "forward": 0.5, "turn": -1}


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (STICK, Stick((12, 500), 1, 0.5, -1.0)),
        ({"t": "alive", "n": N}, Alive((12, 500))),
        ({"t": "let_go", "hold": 3}, LetGo(3)),
        ({"t": "goal", "n": N, "x": 1, "y": 2.5, "yaw": 3.1}, GoalRequest((12, 500), 1.0, 2.5, 3.1)),
        ({"t": "patrol", "n": N, "do": "pause"}, AskPatrol((12, 500), "pause")),
        (
            {"t": "patrol", "n": N, "do": "start", "places": ["sofa", [1, -2.5]], "loop": True, "wait": 2},
            AskPatrol((12, 500), "start", ("sofa", (1.0, -2.5)), True, 2.0),
        ),
        ({"t": "goal", "n": N, "x": 1, "y": 2.5, "yaw": None}, GoalRequest((12, 500), 1.0, 2.5, None)),
        ({"t": "go_to", "n": N, "place": "door"}, GoTo((12, 500), "door")),
        ({"t": "name_place", "place": "door", "x": 1, "y": 2, "yaw": 0}, NamePlace("door", 1.0, 2.0, 0.0)),
        ({"t": "forget_place", "place": "door"}, ForgetPlace("door")),
        ({"t": "cancel"}, Cancel()),
        ({"t": "stop"}, StopAll()),
        ({"t": "release"}, ReleaseAll()),
        ({"t": "obstacles", "on": False}, SwitchObstacleStop(on=False)),
        ({"t": "lease", "n": N, "do": "take"}, AskForLease((12, 500), "take")),
    ],
)
def test_requests_are_read(value: dict[str, Any], expected: object) -> None:
    assert read_request(json.dumps(value)) == expected


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"t": "drive"}, "t: expected one of"),
        ({"t": ["stick"]}, "t: expected one of"),
        ({"n": [1]}, "n: expected a challenge"),
        ({"n": [1, -1]}, "n: expected a challenge"),
        ({"n": [True, 1]}, "n: expected a challenge"),
        ({"hold": 0}, "hold: expected a whole number from 1"),
        ({"hold": 1.5}, "hold: expected"),
        ({"forward": "1"}, "forward: expected a number from -100 to 100"),
        ({"forward": 1e9}, "forward: expected"),
        ({"turn": None}, "turn: expected"),
        ({"turn": True}, "turn: expected"),
    ],
)
def test_malformed_requests_are_refused_in_a_line(change: dict[str, Any], reason: str) -> None:
    with pytest.raises(BadRequestError, match=reason):
        read_request(json.dumps({**STICK, **change}))


@pytest.mark.parametrize("name", ["", "x" * 65, "a\nb", "\x1b[31m", 3, None, ["door"]])
def test_names_that_are_no_text_of_one_line_are_refused(name: object) -> None:
    with pytest.raises(BadRequestError, match="place: expected a name"):
        read_request(json.dumps({"t": "go_to", "n": N, "place": name}))


def test_numbers_that_are_not_finite_long_texts_and_deep_ones_are_refused() -> None:
    for text in (
        json.dumps(STICK).replace("0.5", "NaN"),
        json.dumps(STICK).replace("0.5", "Infinity"),
        " " * (LONGEST + 1),
        "[" * LONGEST,
        "[]",
        "",
    ):
        with pytest.raises(BadRequestError):
            read_request(text)
    with pytest.raises(BadRequestError):
        read_request(b"{}")


VALUES = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(),
    lambda inner: (
        st.lists(inner) | st.dictionaries(st.sampled_from(["t", "n", "hold", "x", "forward", "place"]), inner)
    ),
)


@given(VALUES, st.sampled_from(["stick", "goal", "alive", "lease", "let_go", "go_to", "name_place"]))
def test_whatever_json_comes_is_read_or_refused(value: object, kind: str) -> None:
    for text in (json.dumps(value), json.dumps({**(value if isinstance(value, dict) else {"n": value}), "t": kind})):
        with suppress(BadRequestError):
            assert read_request(text)


def test_request_to_save_the_map_carries_no_name() -> None:
    assert read_request('{"t": "save_map", "name": "../flat"}') == SaveMap()


def test_stop_is_not_refused_for_fields_that_a_newer_page_adds() -> None:
    assert read_request('{"t": "stop", "n": [1, 2], "reason": ["new"]}') == StopAll()
