"""`ur run make_map` from the start to a saved map, without a screen: the robot explores, or drives to places."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.e2e.conftest import ROOT
from tests.e2e.test_programs import run_command, run_program

from ur_nodes.geometry.grid import load_map

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]


def write_two_rooms(folder: Path) -> Path:
    """Write a world of two rooms of 2 m, joined by a door of 0.9 m; the robot begins in the left one."""
    pixels = np.full((44, 84), 254, np.uint8)
    pixels[[0, 1, -2, -1]] = pixels[:, [0, 1, -2, -1]] = 0
    pixels[:22, 41:43] = 0
    pixels[40:, 41:43] = 0
    Image.fromarray(pixels).save(folder / "rooms.png")
    world = folder / "rooms.yaml"
    world.write_text(
        "image: rooms.png\nresolution: 0.05\norigin: [-1.0, -1.1, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
        "free_thresh: 0.25\n"
    )
    return world


def test_robot_explores_two_rooms_then_drives_and_patrols_on_their_map_and_keeps_out_of_a_zone(
    tmp_path: Path, either_ros: dict[str, str]
) -> None:
    world, name = write_two_rooms(tmp_path), tmp_path / "map"
    done = run_program(
        tmp_path,
        "make_map",
        "explore:=true",
        f"world:={world}",
        "map:=rooms",
        f"map_name:={name}",
        "use_rviz:=false",
        keys="",
        more=either_ros,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "the map is complete: 0 frontiers reachable" in done.stdout
    assert "ur run keyboard_navigate map:=rooms" in done.stdout
    grid = load_map(f"{name}.yaml")
    known = float((grid.values == 0).sum()) * grid.resolution**2
    assert 7.0 < known < 8.5

    zone = ("zone", "stairs", "keep-out", "2.2", "-0.9", "3.0", "0.9")
    edited = run_command(tmp_path, str(ROOT / "ur"), "maps", "edit", "rooms", *zone, keys="", more=either_ros)
    assert edited.returncode == 0, edited.stderr
    keys = "g 0.6 0.3 0\nw door\ng 0 0\nw home\ng 2.6 0\npatrol wait=0 door home\n"
    arguments = (f"world:={world}", "map:=rooms", "use_rviz:=false")
    done = run_program(tmp_path, "keyboard_navigate", *arguments, keys=keys, more=either_ros)
    first, _, second, _, kept_out, patrol = done.stdout.splitlines()
    assert first.startswith("g 0.6 0.3 0: reached, ")
    assert second.startswith("g 0 0: reached, ")
    assert "zone" in kept_out
    assert patrol == "patrol wait=0 door home: started"


def test_robot_drives_to_places_on_the_map_that_grows_and_waypoints_belong_to_its_name(tmp_path: Path) -> None:
    world = write_two_rooms(tmp_path)
    keys = "g 0.6 0.3 0\nw here\nsave\nm here\n"
    done = run_program(tmp_path, "make_map", "drive:=goals", f"world:={world}", "use_rviz:=false", keys=keys)
    assert done.returncode == 0, done.stdout + done.stderr
    reached, _, saved, again = done.stdout.splitlines()
    assert reached.startswith("g 0.6 0.3 0: reached, ")
    assert again.startswith("m here: reached, ")
    name = saved.removeprefix("save: map '").removesuffix("' saved")
    folder = tmp_path / "home" / ".local" / "ubiquity_launches"
    assert (folder / "maps" / name / "map.yaml").is_file()
    assert (folder / "waypoints" / f"{name}.yaml").is_file()
