import math
from pathlib import Path

import numpy as np
import pytest

from ur.maps.change import add_edit, make_edit, move_map, propose
from ur.maps.exchange import import_picture
from ur.maps.names import read_places, write_places
from ur.maps.picture_file import write_picture
from ur.maps.record import MapRecord
from ur.maps.scan_file import StoredGraph, encode_graph, read_graph
from ur.maps.store import MapStore
from ur.source.diagnostic import UserError
from ur.worlds.map_file import read_map

VALUES = np.zeros((40, 60), np.int8)
VALUES[:, 30] = 100


@pytest.fixture
def store(tmp_path: Path) -> MapStore:
    made = MapStore(tmp_path / "maps")
    import_picture(made, write_picture(tmp_path / "plan", VALUES, 0.1, (0.0, 0.0, 0.0)), "flat")
    return made


def test_edit_changes_the_picture_and_is_recorded(store: MapStore) -> None:
    assert add_edit(store, "flat", make_edit("erase", [(2.5, 1.0), (3.5, 2.0)])) == 10
    assert (read_map(store.picture("flat")).values == 100).sum() == 30
    assert add_edit(store, "flat", store.record("flat").edits[0]) == 0


@pytest.mark.parametrize("points", [[(0.0, 0.0)], [(0.0, 0.0), (math.nan, 1.0)], [(0.0, 0.0)] * 1001])
def test_edit_without_sensible_points_is_refused(points: list[tuple[float, float]]) -> None:
    with pytest.raises(UserError):
        make_edit("erase", points)


def test_map_graph_and_waypoints_move_together(store: MapStore, tmp_path: Path) -> None:
    graph = StoredGraph(
        np.array(((1.0, 0.0, 0.0),)),
        np.zeros((0, 2), np.int32),
        np.zeros((0, 3)),
        np.zeros((0, 3, 3)),
        np.zeros(0, bool),
    )
    (store.path("flat") / "graph_1.npz").write_bytes(encode_graph(graph))
    store.write_record("flat", MapRecord(graph="graph_1.npz"))
    waypoints = tmp_path / "flat.yaml"
    write_places(waypoints, {"door": (1.0, 0.0, 0.0)})
    move_map(store, "flat", (0.0, 0.0, math.pi / 2), waypoints)
    assert read_places(waypoints)["door"] == pytest.approx((0.0, 1.0, 90.0))
    record = store.record("flat")
    assert read_graph(store.path("flat") / record.graph).poses[0] == pytest.approx((0.0, 1.0, math.pi / 2))
    assert not (store.path("flat") / "graph_1.npz").exists()
    image = read_map(store.picture("flat"))
    assert image.wall_at(-1.0, 3.05) is True
    assert image.wall_at(-1.0, 2.0) is False


def test_shifted_map_keeps_its_cells(store: MapStore, tmp_path: Path) -> None:
    move_map(store, "flat", (-1.0, 0.5, 0.0), tmp_path / "none.yaml")
    image = read_map(store.picture("flat"))
    assert image.origin == (-1.0, 0.5, 0.0)
    assert np.array_equal(image.values, VALUES)
    assert propose(store, "flat") == 0.0
