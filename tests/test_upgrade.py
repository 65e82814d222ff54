"""State of earlier versions stays after an upgrade.

tests/data/previous_version was written by commit 5e5238a, tests/data/version_0_1_0 by the first release.
"""

import math
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ur.cli.main import main
from ur.maps.names import waypoint_path
from ur.maps.record import MapEdit
from ur.maps.store import own_store
from ur.robot.discovery.record import RobotRecord, load_records, records_folder
from ur.robot.discovery.seen import SeenRobot, load_seen, note_seen, seen_path
from ur.robot.selection import Selection, load_selection, selection_path
from ur.robot.sync.steps import WorkspacePair, load_memory, memory_path
from ur.web.access.roles import list_sessions, read_sessions
from ur_nodes.client.waypoints import WaypointStore, name_of_map
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

DATA = Path(__file__).parent / "data"
BOB, EVE = RobotRecord("bob", "ros", "magni", "lidar"), RobotRecord("eve", "pi", "loki")


@pytest.fixture
def environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """The home folder of a user of the version before the first release."""
    return use_home(DATA / "previous_version", tmp_path, monkeypatch)


@pytest.fixture
def released(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """The home folder of a user of version 0.1.0."""
    return use_home(DATA / "version_0_1_0", tmp_path, monkeypatch)


def use_home(state: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    shutil.copytree(state, tmp_path / "home", symlinks=True)
    folders = {"XDG_CONFIG_HOME": "config", "XDG_STATE_HOME": "state", "XDG_DATA_HOME": "share"}
    variables = {name: str(tmp_path / "home" / folder) for name, folder in folders.items()}
    for name, value in {"HOME": str(tmp_path / "home"), **variables}.items():
        monkeypatch.setenv(name, value)
    return {"HOME": str(tmp_path / "home"), **variables}


def test_selection_and_robots_are_those_of_before(
    environment: dict[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert load_selection(selection_path(environment)) == Selection("bob", "magni", "lidar")
    assert load_records(records_folder(environment)) == [BOB, EVE]
    assert load_seen(seen_path(environment)) == {"bob": SeenRobot("bob", "192.168.1.23", 1.7e9)}
    assert main(["use"]) == 0
    assert "bob:magni:lidar" in capsys.readouterr().out


def test_last_synchronisation_of_workspaces_is_known(environment: dict[str, str]) -> None:
    memory = load_memory(memory_path("bob", environment))
    assert memory
    assert memory.pair == WorkspacePair("/home/pat/catkin_ws/src", "/home/ros/catkin_ws/src", "0123abcd")
    assert list(memory.agreed) == ["mine/package.xml"]


def test_waypoints_are_found_under_the_names_of_their_maps(environment: dict[str, str]) -> None:
    store = WaypointStore(waypoint_path("maze", environment))
    places = {name: (place.x, place.y, place.yaw) for name, place in store.places().items()}
    assert places == {"kitchen": (1.5, 2.0, math.pi / 2), "on": (0.0, 0.0, 0.0)}
    unnamed = Grid(np.zeros((2, 3), dtype=np.int8), 0.05, Pose2(-1.0, 2.0, 0.5))
    assert name_of_map(unnamed) == "map-d1735a1e"


def test_what_is_written_now_keeps_what_was_there(environment: dict[str, str]) -> None:
    note_seen(seen_path(environment), [SeenRobot("eve", "192.168.1.31", 1.7e9 + 60)])
    assert set(load_seen(seen_path(environment))) == {"bob", "eve"}
    store = WaypointStore(waypoint_path("maze", environment))
    store.remember("door", Pose2(1.0, 1.0, 0.0))
    assert set(store.places()) == {"door", "kitchen", "on"}
    assert main(["use", "sim:magni"]) == 0
    assert load_records(records_folder(environment)) == [BOB, EVE]
    assert load_selection(selection_path(environment)) == Selection("sim", "magni")


def test_robots_of_0_1_0_are_known_with_their_ros(released: dict[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    assert load_selection(selection_path(released)) == Selection("bob", "magni", "lidar")
    ann = RobotRecord("ann", "ubuntu", "stage", ros="jazzy")
    assert load_records(records_folder(released)) == [ann, replace(BOB, robot_login=True)]
    assert load_seen(seen_path(released)) == {"bob": SeenRobot("bob", "192.168.1.23", 1.7e9)}
    memory = load_memory(memory_path("bob", released))
    assert memory
    assert list(memory.agreed) == ["mine/package.xml"]
    assert main(["use"]) == 0
    assert "bob:magni:lidar" in capsys.readouterr().out


def test_maps_of_0_1_0_are_listed_with_their_zones_and_edits(
    released: dict[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    store = own_store(released)
    assert (store.names(), store.latest()) == (["office"], "office")
    record = store.record("office")
    assert record.edits == (MapEdit("wall", ((0.0, 0.0), (1.0, 0.5)), 0.1),)
    assert [(zone.name, zone.kind, zone.percent) for zone in record.zones] == [
        ("stairs", "keep-out", 0),
        ("ramp", "speed", 40),
    ]
    assert list(WaypointStore(waypoint_path("office", released)).places()) == ["kitchen"]
    assert main(["maps"]) == 0
    assert "office" in capsys.readouterr().out


def test_logins_of_0_1_0_are_known(released: dict[str, str]) -> None:
    web = Path(released["XDG_STATE_HOME"]) / "ubiquity_launches/web"
    (file,) = web.glob("sessions-*.json")
    (login,) = list_sessions(read_sessions(file.read_text()), 1.7e9).values()
    assert "phone" in str(login)
