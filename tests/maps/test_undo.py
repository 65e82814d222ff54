from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from tests.maps.test_scan_file import GRAPH

from ur.maps.change import move_map, write_places
from ur.maps.editing import read_state, restore_state
from ur.maps.picture_file import write_picture
from ur.maps.record import MapRecord
from ur.maps.scan_file import encode_graph, read_graph
from ur.maps.store import MapStore
from ur.source.diagnostic import UserError

VALUES = np.zeros((40, 60), np.int8)
VALUES[:, 30] = 100


@pytest.fixture
def store(tmp_path: Path) -> MapStore:
    made = MapStore(tmp_path / "maps")
    with made.arriving("flat") as folder:
        write_picture(folder / "map", VALUES, 0.1, (0.0, 0.0, 0.0))
    (made.path("flat") / "graph_1.npz").write_bytes(encode_graph(GRAPH))
    made.write_record("flat", MapRecord(graph="graph_1.npz", keyframes=2))
    return made


def test_turned_map_goes_back_with_its_graph_and_waypoints(store: MapStore, tmp_path: Path) -> None:
    waypoints = tmp_path / "flat.yaml"
    write_places(waypoints, "flat", {"door": (1.0, 0.0, 0.0)})
    before, text = read_state(store, "flat", waypoints), waypoints.read_bytes()
    move_map(store, "flat", (1.0, 2.0, math.pi / 3), waypoints)
    restore_state(store, "flat", waypoints, before, store.record("flat"))
    record = store.record("flat")
    graphs = [path.name for path in store.path("flat").glob("graph_*")]
    assert graphs == [record.graph]
    assert read_graph(store.path("flat") / record.graph).poses == pytest.approx(GRAPH.poses)
    after = read_state(store, "flat", waypoints)
    assert np.array_equal(after.image.values, VALUES)
    assert after.image.origin == (0.0, 0.0, 0.0)
    assert waypoints.read_bytes() == text


def test_map_in_use_is_left_alone(store: MapStore, tmp_path: Path) -> None:
    waypoints = tmp_path / "flat.yaml"
    before = read_state(store, "flat", waypoints)
    move_map(store, "flat", (1.0, 0.0, 0.0), waypoints)
    with store.claim("flat"), pytest.raises(UserError, match="in use"):
        restore_state(store, "flat", waypoints, before, store.record("flat"))
    assert read_state(store, "flat", waypoints).image.origin == (1.0, 0.0, 0.0)
