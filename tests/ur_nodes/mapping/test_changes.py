"""Requests to change the map that is served, from text that may come from anybody who reaches the ROS master."""

import json
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ur.maps.exchange import import_picture
from ur.maps.picture_file import write_picture
from ur.maps.store import MapStore
from ur.source.diagnostic import UserError
from ur_nodes.geometry.grid import load_map
from ur_nodes.mapping.changes import attempt, change_walls, read_change, subscribe_changes
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality

STROKE = {"kind": "wall", "points": [[0.5, 1.0], [2.5, 1.0]], "width": 0.2}
DRAW = {"id": "a", "map": "flat", "do": "draw", "strokes": [STROKE]}


@pytest.fixture
def store(tmp_path: Path) -> MapStore:
    made = MapStore(tmp_path / "maps")
    import_picture(made, write_picture(tmp_path / "plan", np.zeros((20, 30), np.int8), 0.1, (0.0, 0.0, 0.0)), "flat")
    return made


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"id": 7}', json.dumps({"id": "x" * 101}), "[" * 9000, "x" * 30_000])
def test_text_that_is_no_request_is_none(text: str) -> None:
    assert read_change(text) is None


def test_walls_are_drawn_and_restored(store: MapStore) -> None:
    served = load_map(store.picture("flat"))
    drawn = change_walls(store, "flat", served, DRAW)
    assert (drawn.values == 100).any()
    assert not (change_walls(store, "flat", drawn, {"map": "flat", "do": "restore"}).values == 100).any()


def test_failed_change_is_described_in_a_line() -> None:
    def fail(problem: Exception) -> None:
        raise problem

    full = OSError(28, "No space left on device")
    assert attempt(lambda: 3, "the map") == (3, "")
    assert attempt(partial(fail, full), "the map") == (None, "the map cannot be written: no space left on device")
    assert attempt(partial(fail, ValueError("line 1\nline 2")), "the map")[1].count("\n") == 0


def test_text_that_is_no_request_is_reported_once_in_a_while() -> None:
    bus = Bus()
    node = bus.node("map_server")
    taken: list[Mapping[str, Any]] = []
    subscribe_changes(node, "wall_request", taken.append)
    client = bus.node("client").publish("wall_request", str, Quality.EVERY)
    for text in ("", "[]", '{"id": "a"}'):
        client.send(text)
    bus.run(0.1)
    assert node.lines == [("error", "/wall_request: not a request, expected JSON with an id")]
    assert taken == [{"id": "a"}]


BAD: list[dict[str, Any]] = [
    {"map": "hall"},
    {"map": None},
    {"do": "delete"},
    {"strokes": None},
    {"strokes": []},
    {"strokes": [STROKE] * 101},
    {"strokes": [STROKE | {"kind": "keep-out"}]},
    {"strokes": [STROKE | {"width": 0}]},
    {"strokes": [STROKE | {"width": 1e9}]},
    {"strokes": [STROKE | {"points": [[0, 0], [float("nan"), 1]]}]},
    {"strokes": [STROKE | {"points": [[0, 0]]}]},
]


@pytest.mark.parametrize("change", BAD)
def test_request_that_makes_no_sense_changes_nothing(store: MapStore, change: dict[str, Any]) -> None:
    served = load_map(store.picture("flat"))
    before = store.picture("flat").read_bytes()
    with pytest.raises((UserError, ValueError, TypeError)):
        change_walls(store, "flat", served, DRAW | change)
    assert store.picture("flat").read_bytes() == before
    assert store.record("flat").edits == ()


def test_map_that_is_not_stored_is_not_changed(store: MapStore) -> None:
    with pytest.raises(ValueError, match="is a file, expected a stored map"):
        change_walls(store, "", load_map(store.picture("flat")), DRAW)


VALUES = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.sampled_from(["kind", "points", "width"]), inner),
)


@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(VALUES)
def test_whatever_strokes_come_are_drawn_or_refused(store: MapStore, strokes: object) -> None:
    served = load_map(store.picture("flat"))
    for each in (strokes, [strokes], [STROKE | (strokes if isinstance(strokes, dict) else {"points": strokes})]):
        with suppress(UserError, ValueError, TypeError):
            change_walls(store, "flat", served, DRAW | {"strokes": each})
