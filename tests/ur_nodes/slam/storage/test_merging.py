import json
from pathlib import Path

import numpy as np
import pytest
from tests.ur_nodes.slam.drives import WALLS, drive, feed

from ur.maps.record import MapEdit, MapRecord
from ur.maps.store import MapStore, own_store
from ur_nodes.geometry.grid import OCCUPIED, load_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.occupancy import OccupancyMap
from ur_nodes.slam.storage import merging
from ur_nodes.slam.storage.writer import MapWriter
from ur_nodes.slam.tracker import MapTracker

WALL = MapEdit("wall", ((0.0, 0.0), (1.0, 0.0)))


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> MapStore:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    return own_store({"XDG_DATA_HOME": str(tmp_path)})


def put(store: MapStore, name: str, first: float, last: float) -> None:
    """Store a map of a drive, with a wall drawn by hand."""
    tracker, drawn = MapTracker(), OccupancyMap()
    feed(tracker, WALLS, drive(first, last), Pose2(0.0, 0.0, 0.0))
    drawn.update(tracker.keyframes, tracker.scans)
    store.path(name).mkdir(parents=True)
    writer = MapWriter(store.path(name), MapRecord(robot="stage", edits=(WALL,)))
    writer.write(drawn.grid(), tracker.keyframes, tracker.edges, tracker.scans)


def run(*arguments: str) -> int:
    return merging.main(arguments)


def test_two_stored_maps_become_a_third(store: MapStore, capsys: pytest.CaptureFixture[str]) -> None:
    put(store, "hall", -2.0, 1.6)
    put(store, "flat", 2.2, -0.6)
    assert run("hall", "flat", "both") == 0
    found = json.loads(capsys.readouterr().out)
    record = store.record("both")
    assert found["name"] == "both"
    assert found["keyframes"] == record.keyframes == store.record("hall").keyframes + store.record("flat").keyframes
    assert found["links"] >= 4
    assert record.edits[0] == WALL
    assert record.edits[1].points[0] == pytest.approx(found["place"][:2])
    assert int(np.sum(load_map(store.picture("both")).values == OCCUPIED)) > 300
    assert run("hall", "flat", "both") == 2
    assert "map 'both' exists" in capsys.readouterr().err


def test_picture_alone_is_refused_and_leaves_nothing(store: MapStore, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("one", "other"):
        store.path(name).mkdir(parents=True)
        store.picture(name).touch()
    assert run("one", "other", "both") == 2
    assert "map 'one' has a picture only" in capsys.readouterr().err
    assert store.names() == ["one", "other"]
