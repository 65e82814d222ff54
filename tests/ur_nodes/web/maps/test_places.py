import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ur.web.wire.map_requests import ForgetPlace, NamePlace
from ur_nodes.client.waypoints import PlaceSettings, WaypointStore, choose_file, name_of_map, read_settings
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.web.maps.place_file import MOST_PLACES, PlaceFile, Places, change_places, read_places

GRID = Grid(np.zeros((3, 4), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))


def test_file_is_that_of_keyboard_navigate() -> None:
    environment = {"XDG_DATA_HOME": "/data", "HOME": "/home/me"}
    folder = Path("/data/ubiquity_launches/waypoints")
    named = read_settings({"map_name": "/maps/flat.yaml", "waypoints_file": "", "save_service": "/save"})
    assert choose_file(named, GRID, environment) == folder / "flat.yaml"
    assert choose_file(read_settings({"waypoints_file": "/x.yaml", "map_name": "flat"}), None, {}) == Path("/x.yaml")
    assert choose_file(PlaceSettings(), GRID, environment) == folder / f"{name_of_map(GRID)}.yaml"
    assert choose_file(PlaceSettings(), None, environment) is None


def name_place(name: str, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> NamePlace:
    return NamePlace(name, x, y, yaw)


def refused(what: str, why: str) -> dict[str, str]:
    return {"t": "refused", "what": what, "why": why}


def test_map_that_grows_has_no_places_until_it_has_a_name() -> None:
    assert choose_file(read_settings({"save_service": "/slam/save"}), GRID, {}) is None
    assert read_places(None, Places()).describe() == {"named": False, "places": {}, "problem": ""}
    assert change_places(None, name_place("door")) == refused("name_place", "no map")


@pytest.mark.parametrize("value", [None, 3, "x", [], {"map_name": 3, "waypoints_file": [1], "save_service": None}])
def test_parameters_of_another_type_are_as_if_missing(value: object) -> None:
    assert read_settings(value) == PlaceSettings()


def test_places_are_shared_with_other_programs(tmp_path: Path) -> None:
    path = tmp_path / "flat.yaml"
    places = read_places(path, Places())
    assert places.describe() == {"named": True, "places": {}, "problem": ""}
    change_places(path, name_place("door", 1.0, 2.0, math.pi / 2))
    assert WaypointStore(path).find("door") == pytest.approx(Pose2(1.0, 2.0, math.pi / 2))
    WaypointStore(path).remember("desk", Pose2(3.0, 4.0, 0.0))
    places = read_places(path, places)
    assert places.describe()["places"] == {"desk": [3.0, 4.0, 0.0], "door": [1.0, 2.0, 1.571]}
    assert read_places(path, places) is places, "a file that has not changed is not read again"
    assert change_places(path, ForgetPlace("door")) == {"t": "done", "what": "forget_place"}
    assert "unknown waypoint" in str(change_places(path, ForgetPlace("door"))["why"])


def test_names_that_keyboard_navigate_refuses_are_refused(tmp_path: Path) -> None:
    for name in ("", "-x", "a ", "a\tb", "a\nb", "../x", "x" * 41):
        assert change_places(tmp_path / "flat.yaml", name_place(name)) == refused("name_place", "name")
    assert list(tmp_path.iterdir()) == []


def test_file_that_cannot_be_read_is_told_and_kept(tmp_path: Path) -> None:
    path = tmp_path / "flat.yaml"
    path.write_text("door: [1, 2]\n")
    places = read_places(path, Places())
    assert "door" in str(places.describe()["problem"])
    assert change_places(path, name_place("desk"))["t"] == "refused"
    assert path.read_text() == "door: [1, 2]\n"
    path.write_text("door: [1, 2, 0]\n")
    assert read_places(path, places).places == {"door": Pose2(1.0, 2.0, 0.0)}


def test_only_names_that_a_page_can_show_are_sent_and_only_so_many(tmp_path: Path) -> None:
    path = tmp_path / "flat.yaml"
    rows = [f"p{number:03d}: [0, 0, 0]\n" for number in range(MOST_PLACES + 5)]
    path.write_text("".join([*rows, '"\\e[31m": [0, 0, 0]\n', f'"{"x" * 100}": [0, 0, 0]\n']))
    shown: Any = read_places(path, Places()).describe()
    places = shown["places"]
    assert len(places) == MOST_PLACES
    assert change_places(path, name_place("another")) == refused("name_place", "full")
    assert all(name.isprintable() and len(name) <= 64 for name in places)


def test_file_is_followed_as_parameters_and_other_programs_change_it(tmp_path: Path) -> None:
    bus, answers = Bus(), list[Mapping[str, Any]]()
    file = PlaceFile(bus.node("web"))
    bus.run(5.0)
    assert file.describe()["named"] is False
    bus.parameters["/keyboard_navigate/waypoints_file"] = str(tmp_path / "a.yaml")
    bus.run(5.0)
    file.change(name_place("door", 1.0), answers.append)
    bus.run(0.0)
    assert answers == [{"t": "done", "what": "name_place"}]
    assert file.find("door") == Pose2(1.0, 0.0, 0.0), "a place is known as soon as its page is told"
    WaypointStore(tmp_path / "a.yaml").remember("desk", Pose2(3.0, 4.0, 0.0))
    bus.run(5.0)
    shown: Any = file.describe()
    assert set(shown["places"]) == {"desk", "door"}
    bus.parameters["/keyboard_navigate/waypoints_file"] = str(tmp_path / "b.yaml")
    bus.run(5.0)
    assert file.describe() == {"named": True, "places": {}, "problem": ""}


def test_places_of_a_map_without_a_name_are_those_of_its_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    bus = Bus()
    file = PlaceFile(bus.node("web"))
    file.show(GRID)
    file.change(name_place("door"), lambda _: None)
    bus.run(1.0)
    file.change(name_place("door"), lambda _: None)
    bus.run(1.0)
    assert [each.stem for each in tmp_path.rglob("*.yaml")] == [name_of_map(GRID)]
