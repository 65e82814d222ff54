"""The node `map_server` on a bus: the map, its zones and its walls."""

import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ur.maps.exchange import import_picture
from ur.maps.picture_file import write_picture
from ur.maps.record import RECORD
from ur.maps.store import MapStore
from ur.maps.zones import make_zone, put_zone
from ur_nodes.geometry.grid import load_map
from ur_nodes.mapping.map_server import MapServer
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap, LoadMap, MapProblem
from ur_nodes.ports.values import Map, MapInfo, Result

ZONE = {"name": "hall", "kind": "keep-out", "points": [[0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [0.5, 1.5]]}
STROKE = {"kind": "wall", "points": [[0.5, 1.0], [2.5, 1.0]], "width": 0.2}


def _add_json(texts: list[dict[str, Any]], text: str) -> None:
    texts.append(json.loads(text))


class MapServerStage:
    """The node, and a client that listens to all that it publishes."""

    def __init__(self, file: Path) -> None:
        self.bus = Bus()
        self.node = self.bus.node("map_server")
        MapServer(self.node, load_map(file), file)
        self.client = self.bus.node("client")
        self.maps: dict[str, Map] = {}
        self.states: dict[str, list[dict[str, Any]]] = {"zones": [], "walls": []}
        self._requests = {
            name: self.client.publish(name, str, Quality.EVERY) for name in ("zone_request", "wall_request")
        }
        for topic in ("map", "keepout_filter_mask", "speed_filter_mask"):
            self.client.subscribe(topic, Map, partial(self.maps.__setitem__, topic), Quality.LATCHED)
        for topic, texts in self.states.items():
            self.client.subscribe(topic, str, partial(_add_json, texts), Quality.LATCHED)
        self.bus.run(0.1)

    @property
    def zones(self) -> dict[str, Any]:
        return self.states["zones"][-1]

    @property
    def walls(self) -> dict[str, Any]:
        return self.states["walls"][-1]

    def ask(self, topic: str, **request: Any) -> None:
        self._requests[topic].send(json.dumps({"id": "a", **request}))
        self.bus.run(0.1)


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> MapStore:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    made = MapStore(tmp_path / "ubiquity_launches" / "maps")
    import_picture(made, write_picture(tmp_path / "plan", np.zeros((20, 30), np.int8), 0.1, (0.0, 0.0, 0.0)), "flat")
    return made


@pytest.fixture
def stage(store: MapStore) -> MapServerStage:
    return MapServerStage(store.picture("flat"))


def test_map_is_published_and_given_on_request(stage: MapServerStage) -> None:
    infos: list[MapInfo] = []
    answers: list[Result] = []
    stage.client.subscribe("map_metadata", MapInfo, infos.append, Quality.LATCHED)
    stage.client.call("static_map", AskMap(), answers.append)
    stage.bus.run(0.1)
    assert (infos[0].width, infos[0].height, infos[0].resolution) == (30, 20, 0.1)
    assert infos[0].stamp == stage.maps["map"].stamp
    assert stage.maps["map"].frame == "map"
    assert stage.maps["map"].grid.values.shape == (20, 30)
    assert answers[0].value is stage.maps["map"]


def test_zones_are_put_and_deleted_on_request_with_their_masks(stage: MapServerStage) -> None:
    assert stage.zones == {"zones": [], "problem": "", "answer": None}
    assert set(stage.maps) == {"map"}, "no mask before the first zone"
    stage.ask("zone_request", do="put", zone=ZONE)
    assert [each["name"] for each in stage.zones["zones"]] == ["hall"]
    assert stage.zones["answer"] == {"id": "a", "problem": ""}
    mask = stage.maps["keepout_filter_mask"]
    assert mask.grid.values.shape == (10, 10)
    assert (mask.grid.values == 100).all()
    assert mask.grid.origin == pytest.approx((0.5, 0.5, 0.0))
    stage.ask("zone_request", do="delete", name="hall")
    assert stage.zones["zones"] == []
    assert stage.maps["keepout_filter_mask"].grid.values.tolist() == [[0]]
    assert "speed_filter_mask" not in stage.maps


def test_zone_of_another_program_is_published_within_a_second(stage: MapServerStage, store: MapStore) -> None:
    slow = make_zone("ramp", "speed", [(0.0, 0.0), (1.0, 1.0)], 40)
    put_zone(store, "flat", slow, load_map(store.picture("flat")))
    stage.bus.run(1.1)
    assert [each["name"] for each in stage.zones["zones"]] == ["ramp"]
    assert int(stage.maps["speed_filter_mask"].grid.values.max()) == 40
    count = len(stage.states["zones"])
    stage.bus.run(5.0)
    assert len(stage.states["zones"]) == count, "nothing new, nothing published"


def test_zones_stay_and_the_reason_is_published_where_their_file_is_damaged(
    stage: MapServerStage, store: MapStore
) -> None:
    stage.ask("zone_request", do="put", zone=ZONE)
    (store.path("flat") / RECORD).write_text("{")
    stage.bus.run(1.1)
    assert [each["name"] for each in stage.zones["zones"]] == ["hall"]
    assert stage.zones["problem"]
    assert stage.node.lines[-1] == ("error", stage.zones["problem"])
    assert (stage.maps["keepout_filter_mask"].grid.values == 100).all()


@pytest.mark.parametrize(
    ("request_", "problem"),
    [({"do": "melt"}, "expected put or delete"), ({"do": "delete", "name": "attic"}, "unknown zone 'attic'")],
)
def test_request_for_zones_that_makes_no_sense_is_answered(
    stage: MapServerStage, request_: dict[str, Any], problem: str
) -> None:
    stage.ask("zone_request", **request_)
    assert problem in stage.zones["answer"]["problem"]
    assert stage.zones["zones"] == []


def test_walls_that_are_drawn_are_in_the_next_map_and_can_be_restored(stage: MapServerStage) -> None:
    assert stage.walls == {"name": "flat", "restorable": False, "answer": None}
    stage.ask("wall_request", map="flat", do="draw", strokes=[STROKE])
    assert stage.walls == {"name": "flat", "restorable": True, "answer": {"id": "a", "problem": ""}}
    assert (stage.maps["map"].grid.values[9:11, 6:24] == 100).all()
    stage.ask("wall_request", map="flat", do="restore")
    assert not stage.maps["map"].grid.values.any()
    assert stage.walls["restorable"] is False
    stage.ask("wall_request", map="flat", do="restore")
    assert "no state before" in stage.walls["answer"]["problem"]


def test_walls_of_a_map_that_is_not_stored_stay_as_they_are(store: MapStore, tmp_path: Path) -> None:
    stage = MapServerStage(write_picture(tmp_path / "plan", np.zeros((5, 5), np.int8), 0.1, (0.0, 0.0, 0.0)))
    assert stage.walls["name"] == ""
    stage.ask("wall_request", map="plan", do="draw", strokes=[STROKE])
    assert "the map in use is a file" in stage.walls["answer"]["problem"]
    assert not (stage.maps["map"].grid.values == 100).any()
    assert store.names() == ["flat"]


def load(stage: MapServerStage, file: str) -> Result:
    answers: list[Result] = []
    stage.client.call("change_map", LoadMap(file), answers.append)
    stage.bus.run(0.2)
    return answers[0]


def test_another_map_is_served_with_its_zones_and_walls_on_request(stage: MapServerStage, store: MapStore) -> None:
    stage.ask("zone_request", do="put", zone=ZONE)
    import_picture(store, write_picture(store.folder / "plan", np.zeros((4, 5), np.int8), 0.2, (1.0, 2.0, 0.0)), "hut")
    answer = load(stage, f"file://{store.picture('hut')}")
    assert answer.success
    assert isinstance(answer.value, Map)
    assert stage.maps["map"].grid.shape == answer.value.grid.shape == (4, 5)
    assert stage.walls["name"] == "hut"
    assert stage.zones["zones"] == []
    assert stage.maps["keepout_filter_mask"].grid.values.max(initial=0) <= 0
    stage.ask("zone_request", do="put", zone=ZONE | {"name": "shed"})
    assert [each["name"] for each in stage.zones["zones"]] == ["shed"]
    assert load(stage, str(store.picture("flat"))).success
    assert [each["name"] for each in stage.zones["zones"]] == ["hall"]
    assert stage.maps["keepout_filter_mask"].grid.values.max() == 100


@pytest.mark.parametrize(
    ("file", "problem", "text"),
    [
        ("/nowhere/map.yaml", MapProblem.MISSING, "there is no file /nowhere/map.yaml"),
        ("map.yaml", MapProblem.UNUSABLE, "file 'map.yaml', expected an absolute path"),
        ("{folder}/broken.yaml", MapProblem.UNUSABLE, ""),
    ],
)
def test_map_that_cannot_be_used_is_refused_and_the_one_before_stays(
    stage: MapServerStage, tmp_path: Path, file: str, problem: MapProblem, text: str
) -> None:
    (tmp_path / "broken.yaml").write_text("image: none.pgm\n")
    answer = load(stage, file.format(folder=tmp_path))
    assert (answer.success, answer.value) == (False, problem)
    assert text in answer.text
    assert stage.maps["map"].grid.shape == (20, 30)
