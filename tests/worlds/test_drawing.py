"""Floor plans made from pictures and sizes."""

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ur.source.diagnostic import UserError
from ur.worlds.drawing import FREE, OCCUPIED, UNKNOWN, Drawing, draw_picture, draw_room, write_png, write_world
from ur.worlds.world_file import WorldModel, read_world


def store(drawing: Drawing, folder: Path, name: str = "home") -> WorldModel:
    (folder / f"{name}.png").write_bytes(write_png(drawing.levels))
    (folder / f"{name}.yaml").write_text(write_world(drawing, f"{name}.png", "A world."))
    return read_world(folder / f"{name}.yaml")


def save(pixels: np.ndarray, path: Path, mode: str = "L") -> Path:
    Image.fromarray(pixels.astype(np.uint8)).convert(mode).save(path)
    return path


def framed(rows: int, columns: int) -> np.ndarray:
    """White floor in a black frame of one pixel."""
    pixels = np.full((rows, columns), 255)
    pixels[[0, -1], :] = pixels[:, [0, -1]] = 0
    return pixels


def test_room_has_its_size_between_walls_and_the_start_in_the_middle(tmp_path: Path) -> None:
    plan = store(draw_room(8.0, 6.0), tmp_path).floor_plan
    for x, y in ((0.0, 0.0), (3.95, 0.0), (-3.95, 0.0), (0.0, 2.95), (0.0, -2.95)):
        assert plan.wall_at(x, y) is False
    for x, y in ((4.05, 0.0), (-4.05, 0.0), (0.0, 3.05), (0.0, -3.05)):
        assert plan.wall_at(x, y)


def test_walls_of_one_pixel_survive_a_picture_that_is_made_much_smaller(tmp_path: Path) -> None:
    pixels = framed(900, 1200)
    pixels[:600, 700] = 0
    drawing = draw_picture(save(pixels, tmp_path / "plan.png"), 6.0)
    assert drawing.levels.shape == (90, 120)
    assert (drawing.levels[:60, 70] == OCCUPIED).all()
    assert (drawing.levels[60:-1, 70] == FREE).all()
    assert not drawing.added_wall


def test_origin_puts_the_start_on_free_floor_with_room_around_it(tmp_path: Path) -> None:
    pixels = framed(200, 300)
    pixels[60:140, 100:200] = 0  # a block in the middle
    world = store(draw_picture(save(pixels, tmp_path / "plan.png"), 15.0), tmp_path)
    for x, y in np.ndindex(11, 11):
        assert world.floor_plan.wall_at((x - 5) * 0.1, (y - 5) * 0.1) is False


def test_paper_around_closed_walls_is_unknown_and_the_start_is_inside(tmp_path: Path) -> None:
    pixels = np.full((300, 300), 255)  # 15 x 15 m of paper around a room of 2 m in a corner
    pixels[20:60, 20:60] = framed(40, 40)
    drawing = draw_picture(save(pixels, tmp_path / "plan.png"), 15.0)
    assert not drawing.added_wall
    assert drawing.levels[150, 150] == UNKNOWN
    assert all(20 < each < 60 for each in drawing.start)


def test_floor_that_reaches_the_edge_is_closed_by_a_wall(tmp_path: Path) -> None:
    drawing = draw_picture(save(np.full((60, 80), 255), tmp_path / "plan.png"), 4.0)
    assert drawing.added_wall
    assert (drawing.levels[[0, -1], :] == OCCUPIED).all()
    assert (drawing.levels[:, [0, -1]] == OCCUPIED).all()


def test_unknown_grey_of_maps_stays_unknown_and_needs_no_wall(tmp_path: Path) -> None:
    pixels = np.full((100, 100), UNKNOWN)
    pixels[10:90, 10:90] = framed(80, 80)
    drawing = draw_picture(save(pixels, tmp_path / "map.pgm"), 5.0)
    assert not drawing.added_wall
    assert drawing.levels[0, 0] == UNKNOWN


@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA", "P", "1"])
def test_pictures_of_every_mode_give_the_same_plan(mode: str, tmp_path: Path) -> None:
    pixels = framed(60, 80)
    pixels[20:40, 60] = 0
    plain = draw_picture(save(pixels, tmp_path / "a.png"), 4.0)
    other = draw_picture(save(pixels, tmp_path / "b.png", mode), 4.0)
    assert np.array_equal(plain.levels, other.levels)


def test_transparent_parts_of_a_picture_are_floor(tmp_path: Path) -> None:
    pixels = np.zeros((60, 80, 4), np.uint8)  # black, and wholly transparent
    pixels[[0, -1], :, 3] = pixels[:, [0, -1], 3] = 255
    Image.fromarray(pixels).save(tmp_path / "plan.png")
    drawing = draw_picture(tmp_path / "plan.png", 4.0)
    assert (drawing.levels[1:-1, 1:-1] == FREE).all()
    assert not drawing.added_wall


@pytest.mark.parametrize(
    ("content", "width", "said"),
    [
        (None, 4.0, "does not exist"),
        (b"no picture at all", 4.0, "is not a picture"),
        (b"\x89PNG\r\n\x1a\n" + b"\x00" * 40, 4.0, "is not a picture|cannot be read"),
        (np.zeros((60, 80)), 4.0, "has no floor"),
        (framed(60, 80), 0.5, "has no floor"),
        (framed(60, 80), 500.0, "expected at most 4000"),
    ],
)
def test_picture_that_makes_no_world_is_refused(
    content: bytes | np.ndarray | None, width: float, said: str, tmp_path: Path
) -> None:
    path = tmp_path / "plan.png"
    if isinstance(content, bytes):
        path.write_bytes(content)
    elif content is not None:
        save(content, path)
    with pytest.raises(UserError, match=said):
        draw_picture(path, width)


def test_examples_in_the_world_file_can_be_uncommented(tmp_path: Path) -> None:
    store(draw_room(8.0, 6.0), tmp_path)
    path = tmp_path / "home.yaml"
    path.write_text(re.sub(r"^# (start|boxes|obstacles|  -)", r"\1", path.read_text(), flags=re.MULTILINE))
    world = read_world(path)
    assert [box.name for box in (*world.boxes, *world.obstacles)] == ["table", "chair"]


def test_map_of_a_map_server_is_a_world(tmp_path: Path) -> None:
    save(framed(60, 80), tmp_path / "map.pgm")
    (tmp_path / "map.yaml").write_text(
        "image: map.pgm\nresolution: 0.1\norigin: [-4.0, -3.0, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    assert read_world(tmp_path / "map.yaml").floor_plan.wall_at(-3.95, 0.0)


def test_world_with_two_floor_plans_is_refused(tmp_path: Path) -> None:
    store(draw_room(2.0, 2.0), tmp_path)
    path = tmp_path / "home.yaml"
    path.write_text("floor_plan: other.yaml\n" + path.read_text())
    with pytest.raises(UserError, match="has an image of its own"):
        read_world(path)
