"""Requests of pages that draw and erase walls: every limit that is named holds."""

import json
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.maps.record import MOST_STROKES, WIDEST_STROKE, MapEdit
from ur.web.wire.map_requests import DrawWalls, RestoreWalls
from ur.web.wire.reading import BadRequestError
from ur.web.wire.requests import LONGEST, read_request

STROKE = [0, 0.1, 1.5, -2.25, 3, 4]


def draw(**change: Any) -> str:
    return json.dumps({"t": "draw_walls", "map": "flat", "strokes": [STROKE]} | change)


def test_strokes_of_a_page_are_edits_of_the_map() -> None:
    points = ((1.5, -2.25), (3.0, 4.0))
    asked = read_request(draw(strokes=[STROKE, [1, 0.8, *STROKE[2:]]]))
    assert asked == DrawWalls("flat", (MapEdit("wall", points, 0.1), MapEdit("erase", points, 0.8)))
    assert read_request('{"t": "restore_walls", "map": "flat"}') == RestoreWalls("flat")


@pytest.mark.parametrize("name", [None, 7, "", "../flat", "a b", "--yes", "x" * 100])
def test_only_the_name_of_a_map_names_one(name: object) -> None:
    for text in (draw(map=name), json.dumps({"t": "restore_walls", "map": name})):
        with pytest.raises(BadRequestError, match="map: expected the name of a map"):
            read_request(text)


@pytest.mark.parametrize(
    "strokes",
    [
        None,
        [],
        {},
        [[]],
        [STROKE[:4]],
        [[*STROKE, 1]],
        [[2, *STROKE[1:]]],
        [["1", *STROKE[1:]]],
        [[[], *STROKE[1:]]],
        [[0, 0, *STROKE[2:]]],
        [[0, -0.1, *STROKE[2:]]],
        [[0, 2 * WIDEST_STROKE, *STROKE[2:]]],
        [[0, True, *STROKE[2:]]],
        [[0, 0.1, 1e9, 0, 0, 0]],
        [[0, 0.1, None, 0, 0, 0]],
        [[0, 1, 1, 1, 1, 1]] * (MOST_STROKES + 1),
    ],
)
def test_strokes_that_are_malformed_or_beyond_a_limit_are_refused(strokes: object) -> None:
    assert len(draw(strokes=strokes)) < LONGEST
    with pytest.raises(BadRequestError, match="strokes: expected"):
        read_request(draw(strokes=strokes))


@pytest.mark.parametrize("number", [float("nan"), float("inf")])
def test_numbers_that_json_lacks_are_refused(number: float) -> None:
    with pytest.raises(BadRequestError, match="expected JSON"):
        read_request(draw(strokes=[[0, 0.1, 0, 0, 0, number]]))


VALUES = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.sampled_from(["map", "strokes", "t"]), inner),
)


@given(VALUES, VALUES)
def test_whatever_json_comes_is_read_or_refused(name: object, strokes: object) -> None:
    for each in (name, "flat"):
        with suppress(BadRequestError):
            assert read_request(draw(map=each, strokes=strokes))
