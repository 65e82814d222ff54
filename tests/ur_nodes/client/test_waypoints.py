import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ur.maps.names import waypoint_path
from ur.source.diagnostic import UserError
from ur_nodes.client.waypoints import WaypointStore, name_of_map
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.navigate.commands import error_line

HERE = Pose2(1.25, -2.5, math.radians(90))


@pytest.fixture
def store(tmp_path: Path) -> WaypointStore:
    return WaypointStore(tmp_path / "deep" / "maze.yaml")


def test_places_are_found_again_by_another_store(store: WaypointStore) -> None:
    assert store.remember("kitchen", HERE)
    assert WaypointStore(store.path).find("kitchen") == pytest.approx(HERE)


@pytest.mark.parametrize("name", ["007", "yes", "null", "1e3", "küche"])
def test_names_that_look_like_values_stay_names(store: WaypointStore, name: str) -> None:
    store.remember(name, HERE)
    assert list(store.places()) == [name]


def test_remembering_a_name_again_moves_it(store: WaypointStore) -> None:
    store.remember("a", HERE)
    assert not store.remember("a", Pose2(0.0, 0.0, 0.0))
    assert store.find("a") == (0.0, 0.0, 0.0)


def test_forgotten_name_is_gone_and_the_file_still_good(store: WaypointStore) -> None:
    store.remember("a", HERE)
    store.forget("a")
    assert store.places() == {}


def test_unknown_name_says_which_there_are(store: WaypointStore) -> None:
    store.remember("kitchen", HERE)
    with pytest.raises(UserError) as caught:
        store.find("kitchn")
    assert "expected one of: kitchen (did you mean 'kitchen'?)" in error_line(caught.value)


def test_file_with_an_error_is_refused_and_left_alone(store: WaypointStore) -> None:
    store.path.parent.mkdir()
    store.path.write_text("a: [1, 2, 3]\nb: [1, 2]\n")
    with pytest.raises(UserError) as caught:
        store.remember("c", HERE)
    assert str(caught.value).startswith(f"{store.path}:2:4: ")
    assert "c" not in store.path.read_text()


def test_interrupted_write_leaves_the_old_file(store: WaypointStore) -> None:
    store.remember("a", HERE)
    before = store.path.read_text()

    def interrupt(_: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        WaypointStore(store.path, interrupt).remember("b", HERE)
    assert store.path.read_text() == before
    assert [path.name for path in store.path.parent.iterdir()] == ["maze.yaml"]


def test_file_that_cannot_be_written_is_a_user_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="expected a writable waypoint file"):
        WaypointStore(tmp_path / "file" / "maze.yaml").remember("a", HERE)


@pytest.mark.parametrize(("name", "stem"), [("maze", "maze"), ("/a/b/office.yaml", "office"), ("my map", "my_map")])
def test_path_follows_xdg(name: str, stem: str) -> None:
    assert waypoint_path(name, {"XDG_DATA_HOME": "/data"}) == Path(f"/data/ubiquity_launches/waypoints/{stem}.yaml")
    assert waypoint_path(name, {"HOME": "/home/me"}).parts[:5] == ("/", "home", "me", ".local", "share")


def test_name_of_a_nameless_map_depends_on_its_content() -> None:
    grid = Grid(np.zeros((2, 3), np.int8), 0.05, Pose2(0, 0, 0))
    assert name_of_map(grid) == name_of_map(replace(grid, values=grid.values.copy()))
    assert name_of_map(grid) != name_of_map(replace(grid, values=grid.values + np.int8(1)))
    assert name_of_map(grid) != name_of_map(replace(grid, resolution=0.1))
