import importlib.util
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from PIL import Image
from scipy import ndimage

from ur.source.diagnostic import UserError
from ur.worlds.world_file import WorldModel, read_world

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "ubiquity_launches"
WORLDS = sorted(path.stem for path in (PACKAGE / "n_simulator" / "worlds").glob("*.yaml"))


@pytest.fixture(scope="module")
def make_worlds() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_worlds", ROOT / "tools" / "make_worlds.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    import sys

    sys.modules["make_worlds"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def test_worlds_are_what_the_script_makes(make_worlds: ModuleType, tmp_path: Path) -> None:
    for drawing in (make_worlds.draw_maze(), make_worlds.draw_office()):
        make_worlds.write_world(drawing, tmp_path)
    made = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*.*"))
    assert [path.stem for path in made if path.suffix == ".png"] == WORLDS
    for path in made:
        if path.suffix == ".png":
            assert np.array_equal(np.asarray(Image.open(tmp_path / path)), np.asarray(Image.open(PACKAGE / path)))
        else:
            assert (tmp_path / path).read_text() == (PACKAGE / path).read_text()


@pytest.mark.parametrize("name", WORLDS)
def test_worlds_can_be_driven_everywhere_from_the_start(name: str) -> None:
    plan = read_world(PACKAGE / "n_simulator" / "worlds" / f"{name}.yaml").floor_plan
    pixels = np.flipud(np.asarray(Image.open(PACKAGE / "n_map_server" / "maps" / f"{name}.png")))
    room = ndimage.distance_transform_edt(pixels == 254) * plan.resolution > 0.30  # the robot, and some to spare
    labels, _ = ndimage.label(room)
    here = labels[int(-plan.origin[1] / plan.resolution), int(-plan.origin[0] / plan.resolution)]
    assert here > 0
    assert (labels == here).sum() / room.sum() > 0.999


@pytest.mark.parametrize("name", WORLDS)
def test_worlds_are_closed_and_unknown_outside(name: str) -> None:
    pixels = np.asarray(Image.open(PACKAGE / "n_map_server" / "maps" / f"{name}.png"))
    outside, _ = ndimage.label(pixels != 0)
    assert set(np.unique(pixels[outside == outside[0, 0]])) == {205}
    assert 14 < pixels.shape[0] * 0.05 < 17
    assert 19 < pixels.shape[1] * 0.05 < 22


def test_world_reads_boxes_obstacles_and_start(make_world: Callable[[str], WorldModel]) -> None:
    world = make_world(
        "wall_height: 2\nstart: [1, 0.5, 0.3]\n"
        "boxes:\n  - {name: shelf, pose: [1, 1, 0.5, 0], size: [0.4, 0.2, 1.0]}\n"
        "obstacles:\n  - {name: crate, pose: [2, 1, 0], size: [0.3, 0.3, 0.6], mass: 5}\n"
    )
    assert world.start == (1.0, 0.5, 0.3)
    assert world.wall_height == 2.0
    assert [(box.name, box.mass) for box in world.boxes] == [("shelf", None)]
    assert [(box.name, box.pose, box.mass) for box in world.obstacles] == [("crate", (2.0, 1.0, 0.3, 0.0), 5.0)]


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("wall_hight: 2\n", r"world.yaml:2:1: wall_hight is not known"),
        ("boxes:\n  - {name: a, pose: [1, 2], size: [1, 1, 1]}\n", r"world.yaml:3:21: pose: .* a list of 4 numbers"),
        ("boxes:\n  - {name: a, pose: [1, 2, 3, 0], size: [1, 0, 1]}\n", r"world.yaml:3:41: size: .* above 0"),
        ("obstacles:\n  - {name: a, pose: [1, 2, 0], size: [1, 1, 1]}\n", r"mass is missing"),
        (
            "boxes:\n  - {name: a, pose: [1, 2, 3, 0], size: [1, 1, 1]}\n"
            "  - {name: a, pose: [1, 2, 3, 0], size: [1, 1, 1]}\n",
            r"world.yaml:4:12: name: 'a' is given twice",
        ),
        ("drops:\n  - {pose: [1, 2, 0], size: [1, 0]}\n", r"world.yaml:3:29: size: .* two lengths above 0"),
        ("drops:\n  - {pose: [1, 2], size: [1, 1]}\n", r"pose: .* a list of 3 numbers"),
        ("boxes: [\n", r"world.yaml:3:1: not valid YAML"),
    ],
)
def test_world_mistakes_are_named_with_their_place(
    make_world: Callable[[str], WorldModel], lines: str, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        make_world(lines)


def test_world_without_its_floor_plan_is_named(tmp_path: Path) -> None:
    (tmp_path / "w.yaml").write_text("floor_plan: gone.yaml\n")
    with pytest.raises(UserError, match=r"w.yaml:1:13: floor_plan: .*gone.yaml does not exist"):
        read_world(tmp_path / "w.yaml")


def test_world_that_does_not_exist_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"gone.yaml: no such file"):
        read_world(tmp_path / "gone.yaml")


def test_fiducials_are_read_with_the_size_of_all_or_their_own(make_world: Callable[[str], WorldModel]) -> None:
    world = make_world(
        "fiducials:\n  dictionary: 4X4_50\n  size: 0.2\n  places:\n"
        "    - {id: 1, pose: [1, 2, 2.4, 3.14, 0, 0]}\n    - {id: 2, pose: [0, 0, 1, 0, 0, 0], size: 0.1}\n"
    )
    assert [(f.id, f.size, f.dictionary) for f in world.fiducials] == [(1, 0.2, "4X4_50"), (2, 0.1, "4X4_50")]
    assert world.fiducials[0].pose == (1.0, 2.0, 2.4, 3.14, 0.0, 0.0)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("  dictionary: 5X5_100O\n  places: []\n", "dictionary: '5X5_100O'"),
        ("  places:\n    - {id: 1000, pose: [0, 0, 0, 0, 0, 0]}\n", "id: 1000 is not in 5X5_1000"),
        ("  places:\n" + "    - {id: 1, pose: [0, 0, 0, 0, 0, 0]}\n" * 2, "id: 1 is given twice"),
        ("  places:\n    - {id: 1, pose: [0, 0, 0]}\n", "expected a list of 6 numbers"),
        ("  places:\n    - {id: 1, pose: [0, 0, 0, 0, 0, 0], size: 0}\n", "size: 0"),
        ("  place: []\n", "place is not known"),
    ],
)
def test_fiducials_that_cannot_be_are_refused(
    make_world: Callable[[str], WorldModel], lines: str, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        make_world("fiducials:\n" + lines)


def test_fiducials_of_the_office_hang_over_free_floor_and_face_away_from_walls() -> None:
    from ur_nodes.simulator.scenery import rotation_axes

    world = read_world(PACKAGE / "n_simulator" / "worlds" / "office.yaml")
    down = [f for f in world.fiducials if rotation_axes(f.pose[3:])[2][2] < -0.99]
    on_walls = [f for f in world.fiducials if abs(rotation_axes(f.pose[3:])[2][2]) < 0.01]
    assert len(down) > 30
    assert len(on_walls) > 30
    assert len(down) + len(on_walls) == len(world.fiducials)
    for fiducial in world.fiducials:
        (x, y, z), normal = fiducial.pose[:3], rotation_axes(fiducial.pose[3:])[2]
        assert world.floor_plan.wall_at(x, y) is False
        if fiducial in on_walls:
            assert world.floor_plan.wall_at(x - 0.02 * normal[0], y - 0.02 * normal[1])
            assert z + fiducial.size < world.wall_height
            assert rotation_axes(fiducial.pose[3:])[1][2] > 0.99  # upright
