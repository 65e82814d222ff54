"""`ur maps merge`, with the process that merges."""

import json
import math
import os
import select
import subprocess
import sys
from pathlib import Path

import pytest
from tests.ur_nodes.slam.drives import drive
from tests.ur_nodes.slam.storage.test_merging import put, store

from ur.cli.main import main
from ur.maps.names import read_places, waypoint_path, write_places
from ur.maps.store import MapStore
from ur_nodes.geometry.pose import Pose2

__all__ = ["store"]


@pytest.mark.ros
def test_merged_map_has_the_waypoints_of_both(store: MapStore, capsys: pytest.CaptureFixture[str]) -> None:
    put(store, "hall", -2.0, 1.6)
    put(store, "attic", 2.2, -0.6)
    write_places(waypoint_path("hall", os.environ), {"door": (0.5, 0.0, 90.0)})
    write_places(waypoint_path("attic", os.environ), {"door": (9.0, 9.0, 0.0), "sofa": (-0.2, 0.3, 0.0)})
    assert main(["maps", "merge", "hall", "attic", "--as", "house"]) == 0
    assert "of hall: door" in capsys.readouterr().out
    places = read_places(waypoint_path("house", os.environ))
    assert places["door"] == (0.5, 0.0, 90.0)
    hall, attic = drive(-2.0, 1.6)[0], drive(2.2, -0.6)[0]  # where their maps begin in the world
    sofa = hall.inverse().compose(attic).compose(Pose2(-0.2, 0.3, 0.0))
    assert places["sofa"] == pytest.approx((sofa.x, sofa.y, math.degrees(sofa.yaw)), abs=0.1)
    assert store.names() == ["attic", "hall", "house"]


def test_map_is_not_merged_with_itself(store: MapStore, capsys: pytest.CaptureFixture[str]) -> None:
    put(store, "hall", -2.0, 1.6)
    assert main(["maps", "merge", "hall", "hall", "--as", "house"]) == 2
    assert "same-map" in capsys.readouterr().err
    assert store.names() == ["hall"]


MERGED = """
import sys
from ur.cli.maps import merging
from ur.maps.store import own_store
merging.need_all = lambda *_: None
sys.executable = sys.argv[1]
print(merging.merge_maps(own_store({**__import__("os").environ}), "hall", "attic", "house"))
"""


def test_places_where_the_maps_differ_are_shown(store: MapStore, tmp_path: Path) -> None:
    program = tmp_path / "program"
    changes = [[1.0, -2.0, 1.25, 0.5]] * 12
    found = {"name": "house", "keyframes": 9, "links": 5, "place": [0.0, 0.0, 0.0], "changes": changes}
    program.write_text(f"#!/bin/sh\necho '{json.dumps(found)}'\n")
    program.chmod(0o755)
    for name in ("hall", "attic"):
        store.path(name).mkdir(parents=True)
        store.picture(name).touch()
    command = [sys.executable, "-c", MERGED, str(program)]
    first, *places = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    assert first == "house: 9 scans, 5 links between the two maps"
    assert places[0] == "The maps differ in 12 places, drawn as in attic:"
    assert places[1:] == ["  1.2 x 0.5 m at (1.0, -2.0)"] * 10


def test_merging_process_ends_with_a_command_that_is_killed(store: MapStore, tmp_path: Path) -> None:
    put(store, "hall", -2.0, 1.6)
    put(store, "attic", 2.2, -0.6)
    number = tmp_path / "number"
    program = tmp_path / "program"
    os.mkfifo(number)
    program.write_text(f"#!/bin/sh\necho $$ >{number}; exec sleep 1000\n")
    program.chmod(0o755)
    command = subprocess.Popen([sys.executable, "-c", MERGED, str(program)], stdout=subprocess.DEVNULL)
    with number.open() as pipe:  # waits until the process has begun
        child = os.pidfd_open(int(pipe.readline()))
    command.kill()
    command.wait()
    ended, _, _ = select.select([child], [], [], 60.0)
    os.close(child)
    assert ended
