from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from ur.source.diagnostic import UserError
from ur_nodes.client.waypoints import PlaceSettings, WaypointStore, choose_file, name_of_map, read_settings
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.web.places import MOST_PLACES, Places

GRID = Grid(np.zeros((3, 4), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))


def test_file_is_that_of_keyboard_navigate() -> None:
    environment = {"XDG_DATA_HOME": "/data", "HOME": "/home/me"}
    folder = Path("/data/ubiquity_launches/waypoints")
    named = read_settings({"map_name": "/maps/flat.yaml", "waypoints_file": "", "save_service": "/save"})
    assert choose_file(named, GRID, environment) == folder / "flat.yaml"
    assert choose_file(read_settings({"waypoints_file": "/x.yaml", "map_name": "flat"}), None, {}) == Path("/x.yaml")
    assert choose_file(PlaceSettings(), GRID, environment) == folder / f"{name_of_map(GRID)}.yaml"
    assert choose_file(PlaceSettings(), None, environment) is None


def test_map_that_grows_has_no_places_until_it_has_a_name() -> None:
    assert choose_file(read_settings({"save_service": "/slam/save"}), GRID, {}) is None
    places = Places()
    places.use(None)
    assert places.describe() == {"named": False, "places": {}, "problem": ""}
    with pytest.raises(ValueError, match="no map"):
        places.remember("door", Pose2(0.0, 0.0, 0.0))


@pytest.mark.parametrize("value", [None, 3, "x", [], {"map_name": 3, "waypoints_file": [1], "save_service": None}])
def test_parameters_of_another_type_are_as_if_missing(value: object) -> None:
    assert read_settings(value) == PlaceSettings()


def test_places_are_shared_with_other_programs(tmp_path: Path) -> None:
    path, places = tmp_path / "flat.yaml", Places()
    places.use(path)
    assert places.describe() == {"named": True, "places": {}, "problem": ""}
    places.remember("door", Pose2(1.0, 2.0, math.pi / 2))
    assert WaypointStore(path).find("door") == pytest.approx(Pose2(1.0, 2.0, math.pi / 2))
    WaypointStore(path).remember("desk", Pose2(3.0, 4.0, 0.0))
    places.use(path)
    assert places.describe()["places"] == {"desk": [3.0, 4.0, 0.0], "door": [1.0, 2.0, 1.571]}
    places.forget("door")
    assert places.find("door") is None
    with pytest.raises(UserError, match="unknown waypoint"):
        places.forget("door")


def test_names_that_keyboard_navigate_refuses_are_refused(tmp_path: Path) -> None:
    places = Places()
    places.use(tmp_path / "flat.yaml")
    for name in ("", "-x", "a ", "a\tb", "a\nb", "../x", "x" * 41):
        with pytest.raises(ValueError, match="name"):
            places.remember(name, Pose2(0.0, 0.0, 0.0))
    assert list(tmp_path.iterdir()) == []


def test_file_that_cannot_be_read_is_told_and_kept(tmp_path: Path) -> None:
    path, places = tmp_path / "flat.yaml", Places()
    path.write_text("door: [1, 2]\n")
    places.use(path)
    assert "door" in places.describe()["problem"]
    with pytest.raises(UserError):
        places.remember("desk", Pose2(0.0, 0.0, 0.0))
    assert path.read_text() == "door: [1, 2]\n"
    path.write_text("door: [1, 2, 0]\n")
    places.use(path)
    assert places.find("door") == Pose2(1.0, 2.0, 0.0)


def test_only_names_that_a_page_can_show_are_sent_and_only_so_many(tmp_path: Path) -> None:
    path, places = tmp_path / "flat.yaml", Places()
    rows = [f"p{number:03d}: [0, 0, 0]\n" for number in range(MOST_PLACES + 5)]
    path.write_text("".join([*rows, '"\\e[31m": [0, 0, 0]\n', f'"{"x" * 100}": [0, 0, 0]\n']))
    places.use(path)
    assert len(places.describe()["places"]) == MOST_PLACES
    with pytest.raises(ValueError, match="full"):
        places.remember("another", Pose2(0.0, 0.0, 0.0))
    assert all(name.isprintable() and len(name) <= 64 for name in places.describe()["places"])
