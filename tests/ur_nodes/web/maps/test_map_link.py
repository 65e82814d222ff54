"""The map in use on a bus: requests of pages to save one, and to change its walls, zones and places."""

import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.ur_nodes.web.robot_world import DrivingPage, RobotWorld

from ur.maps.exchange import import_picture
from ur.maps.picture_file import write_picture
from ur.maps.store import MapStore
from ur.web.wire.frames import TILE, Kind, Layer, key_of
from ur_nodes.geometry.grid import load_map
from ur_nodes.mapping.map_server import MapServer
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap, Trigger
from ur_nodes.ports.values import Result
from ur_nodes.web.maps.map_link import choose_name, choose_service

UNKNOWN = {"name": "", "restorable": False, "why": "no server"}


def test_only_names_of_services_and_of_stored_maps_count() -> None:
    assert choose_service(["", 7, None, "no service", "a/b", "c"]) == "a/b"
    assert choose_service(["http://x", "//", "x" * 300]) == ""
    assert choose_name("flat", made=False) == "flat"
    assert choose_name("flat", made=True) == ""
    for value in ("", "/opt/maps/maze.yaml", "latest", "a b", 7, None, ["flat"]):
        assert choose_name(value, made=False) == ""


class MapWorld(RobotWorld):
    """A robot, and a page that may drive it."""

    def __init__(self) -> None:
        super().__init__()
        self.page = DrivingPage(self)

    def map(self) -> dict[str, Any]:
        """The map as pages see it, once it has been asked for."""
        self.bus.run(4.0)
        found: dict[str, Any] = self.state()["map"]
        return found

    def ask(self, request: str, seconds: float = 1.0, **more: Any) -> dict[str, Any]:
        """The one answer to a request."""
        self.page.ask(request, **more)
        (answer,) = self.page.told(seconds)
        return answer

    def cells(self, shape: tuple[int, ...]) -> NDArray[np.int8]:
        """The cells that pages show."""
        self.state()
        tile = next(each for each in reversed(self.view.frames) if key_of(each) == (Kind.TILE, Layer.MAP, 0, 0))
        cells = np.frombuffer(zlib.decompress(tile[10:]), np.int8).reshape(TILE, TILE)
        return cells[: shape[0], : shape[1]]

    def serve_map(self, file: Path) -> None:
        MapServer(self.bus.node("map_server"), load_map(file), file)
        self.bus.run(0.5)


@pytest.fixture
def world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> MapWorld:
    for name in ("ROS_HOME", "XDG_DATA_HOME"):
        monkeypatch.setenv(name, str(tmp_path))
    monkeypatch.setenv("ROS_MASTER_URI", "http://robot:1")
    return MapWorld()


def test_page_is_told_the_map_in_use_and_saves_the_one_that_is_made(world: MapWorld) -> None:
    world.bus.parameters["/keyboard_navigate/map_name"] = "flat"  # its node may be left out
    assert world.map()["name"] == "", "no map server runs"
    server = world.bus.node("map_server")
    server.serve("static_map", AskMap, lambda _: Result(True))
    assert world.map() == {"name": "flat", "saves": False, "walls": UNKNOWN}
    assert world.ask("save_map") == {"t": "refused", "why": "no map", "what": "save_map"}

    answers = iter([Result(True, "flat"), Result(False, "the disk is full"), Result(True, "../x")])
    saver = world.bus.node("slam_gmapping")
    saver.serve("slam_gmapping/save", Trigger, lambda _: next(answers))
    world.bus.parameters["/teleop_twist_keyboard/save_service"] = "slam_gmapping/save"
    assert world.map() == {"name": "", "saves": True, "walls": UNKNOWN | {"why": "made"}}
    assert world.ask("save_map") == {"t": "done", "name": "flat", "what": "save_map"}
    assert world.ask("save_map") == {"t": "refused", "why": "the disk is full", "what": "save_map"}
    assert "no name of a map" in world.ask("save_map")["why"]
    saver.end("done")
    assert world.map()["saves"] is False, "the parameter stays, the node has ended"


def test_map_that_is_being_saved_is_not_saved_again(world: MapWorld) -> None:
    waiting: list[Any] = []
    world.robot.serve_later("save", Trigger, lambda _, give: waiting.append(give))
    world.bus.parameters["/explore/save_service"] = "save"
    assert world.map()["saves"] is True
    world.page.ask("save_map")
    world.bus.run(1.0)
    assert world.ask("save_map") == {"t": "refused", "why": "busy", "what": "save_map"}
    waiting[0](Result(True, "hall"))
    assert world.page.told() == [{"t": "done", "name": "hall", "what": "save_map"}]


def test_walls_that_a_page_draws_are_stored_published_and_restored(world: MapWorld, tmp_path: Path) -> None:
    store = MapStore(tmp_path / "ubiquity_launches" / "maps")
    before = np.zeros((20, 30), np.int8)
    import_picture(store, write_picture(tmp_path / "plan", before, 0.1, (0.0, 0.0, 0.0)), "flat")
    draw: dict[str, Any] = {"map": "flat", "strokes": [[0, 0.2, 0.5, 1, 2.5, 1], [1, 0.4, 1.5, 0, 1.5, 2]]}
    assert world.ask("draw_walls", **draw) == {"t": "refused", "why": "no walls", "what": "draw_walls"}
    world.serve_map(store.picture("flat"))
    assert world.map()["walls"] == {"name": "flat", "restorable": False, "why": ""}
    assert np.array_equal(world.cells(before.shape), before)
    assert world.ask("draw_walls", **draw) == {"t": "done", "what": "draw_walls"}
    after = before.copy()
    after[9:11, 4:26] = 100
    after[:, 13:17] = 0
    assert np.array_equal(world.cells(before.shape), after)
    assert world.map()["walls"] == {"name": "flat", "restorable": True, "why": ""}
    assert [each.kind for each in store.record("flat").edits] == ["wall", "erase"]
    assert "in use is flat" in world.ask("draw_walls", **draw | {"map": "hall"})["why"]
    assert world.ask("restore_walls", map="flat") == {"t": "done", "what": "restore_walls"}
    assert np.array_equal(world.cells(before.shape), before)
    assert world.ask("restore_walls", map="flat")["t"] == "refused"


def test_walls_of_a_map_that_is_not_stored_stay_as_they_are(world: MapWorld, tmp_path: Path) -> None:
    world.serve_map(write_picture(tmp_path / "plan", np.zeros((5, 5), np.int8), 0.1, (0.0, 0.0, 0.0)))
    assert world.map()["walls"] == {"name": "", "restorable": False, "why": "file"}
    answer = world.ask("draw_walls", map="plan", strokes=[[0, 0.2, 0, 0, 1, 1]])
    assert "the map in use is a file" in answer["why"]


def test_zones_are_shown_changed_and_refused_where_no_map_server_has_them(world: MapWorld, tmp_path: Path) -> None:
    put: dict[str, Any] = {"zone": "stairs", "percent": 0, "corners": [0.0, 0.0, 1.0, 0.0, 1.0, 1.0]}
    assert world.ask("put_zone", **put) == {"t": "refused", "why": "no zones", "what": "put_zone"}
    world.serve_map(write_picture(tmp_path / "plan", np.zeros((50, 50), np.int8), 0.1, (0.0, 0.0, 0.0)))
    assert world.ask("put_zone", **put) == {"t": "done", "what": "put_zone"}
    world.state()
    shown = world.view.newest(Kind.ZONES)
    assert shown["served"] is True
    assert [(each["name"], each["percent"], each["corners"]) for each in shown["zones"]] == [
        ("stairs", 0, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    ]
    assert world.ask("delete_zone", zone="stairs") == {"t": "done", "what": "delete_zone"}
    assert world.ask("delete_zone", zone="stairs")["t"] == "refused"


@pytest.mark.parametrize("topic", ["zones", "walls"])
def test_state_that_is_not_that_of_a_map_server_is_reported_and_ignored(world: MapWorld, topic: str) -> None:
    texts = world.robot.publish(topic, str, Quality.LATCHED)
    for text in ("{", "[]", '{"answer": 3}', "x" * 2_000_001):
        texts.send(text)
        world.bus.run(0.1)
    assert any(f"{topic}: not what a map server publishes" in text for _, text in world.node.lines)
    assert world.view.newest(Kind.ZONES)["zones"] == []


def test_page_names_a_place_and_drives_to_it(world: MapWorld, tmp_path: Path) -> None:
    world.bus.parameters["/keyboard_navigate/waypoints_file"] = str(tmp_path / "places.yaml")
    world.bus.run(4.0)
    assert world.ask("name_place", place="door", x=1.0, y=2.0, yaw=0.0) == {"t": "done", "what": "name_place"}
    world.state()
    assert world.view.newest(Kind.PLACES)["places"] == {"door": [1.0, 2.0, 0.0]}
    assert world.ask("go_to", place="door") == {"t": "sent", "what": "goal", "number": 1}
    assert tuple(world.navigation.goals[0].goal.target.pose) == (1.0, 2.0, 0.0)
    assert world.ask("forget_place", place="door") == {"t": "done", "what": "forget_place"}
