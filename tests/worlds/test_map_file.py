from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ur.source.diagnostic import UserError
from ur.worlds.map_file import read_map
from ur_nodes.geometry.grid import load_map
from ur_nodes.geometry.pose import Pose2

HEAD = "resolution: 0.05\norigin: [1, -2.5, 0.25]\n"
THRESHOLDS = "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


def write_map(folder: Path, pixels: object, text: str = THRESHOLDS, name: str = "plan.png") -> Path:
    Image.fromarray(np.asarray(pixels, dtype=np.uint8)).save(folder / name)
    file = folder / "plan.yaml"
    file.write_text(f"image: {name}\n{HEAD}{text}")
    return file


def values(folder: Path, pixels: object, text: str = THRESHOLDS, name: str = "plan.png") -> list[list[int]]:
    grid = load_map(write_map(folder, pixels, text, name))
    return [[int(value) for value in row] for row in grid.values]


def test_load_map_puts_the_last_row_of_the_image_first(tmp_path: Path) -> None:
    assert values(tmp_path, [[0, 0, 0], [255, 205, 0]]) == [[0, -1, 100], [100, 100, 100]]


def test_load_map_takes_resolution_and_origin(tmp_path: Path) -> None:
    grid = load_map(write_map(tmp_path, [[0]]))
    assert (grid.resolution, grid.origin) == (0.05, Pose2(1.0, -2.5, 0.25))


def test_load_map_reads_numbers_from_texts_as_map_server_does(tmp_path: Path) -> None:
    file = write_map(tmp_path, [[0, 255]])
    text = file.read_text().replace("0.05", "5e-2").replace("[1, -2.5, 0.25]", '["1", -010, 25e-2]')
    file.write_text(text.replace("negate: 0", 'negate: "0"').replace("0.65", '"0.65"'))
    grid = load_map(file)
    assert (grid.resolution, grid.origin) == (0.05, Pose2(1.0, -10.0, 0.25))
    assert grid.values.tolist() == [[100, 0]]


def test_load_map_follows_a_world_file_to_its_floor_plan(tmp_path: Path) -> None:
    (tmp_path / "maps").mkdir()
    write_map(tmp_path / "maps", [[0, 255]])
    (tmp_path / "world.yaml").write_text("floor_plan: maps/plan.yaml\nwall_height: 2.0\n")
    assert load_map(tmp_path / "world.yaml").values.tolist() == [[100, 0]]


# p = (255 - pixel) / 255; thresholds are exclusive: 0.65 * 255 = 165.75 -> 89 is 166 dark, 90 is 165; 0.196 -> 49.98.
def test_load_map_trinary_compares_strictly_with_the_thresholds(tmp_path: Path) -> None:
    assert values(tmp_path, [[89, 90, 205, 206]]) == [[100, -1, -1, 0]]


def test_load_map_negate_swaps_black_and_white(tmp_path: Path) -> None:
    text = THRESHOLDS.replace("negate: 0", "negate: 1")
    assert values(tmp_path, [[0, 255, 100]], text) == [[0, 100, -1]]


def test_load_map_scale_spreads_what_is_between(tmp_path: Path) -> None:
    # p(128) = 127/255 = 0.49804; 1 + 98 * (0.49804 - 0.196) / 0.454 = 66.2
    assert values(tmp_path, [[0, 255, 128, 205, 90]], THRESHOLDS + "mode: scale\n") == [[100, 0, 66, 1, 98]]


def test_load_map_scale_takes_transparent_pixels_between_as_unknown(tmp_path: Path) -> None:
    pixels = [[[128, 128, 128, 0], [128, 128, 128, 255], [0, 0, 0, 0], [255, 255, 255, 0]]]
    assert values(tmp_path, pixels, THRESHOLDS + "mode: scale\n") == [[-1, 66, 100, 0]]


def test_load_map_trinary_averages_alpha_with_the_colours(tmp_path: Path) -> None:
    # (0 + 0 + 0 + 255) / 4 = 63.75: p = 0.75; (0 * 3 + 0) / 4: p = 1; (255 * 3 + 0) / 4 = 191.25: p = 0.25
    assert values(tmp_path, [[[0, 0, 0, 255], [0, 0, 0, 0], [255, 255, 255, 0]]]) == [[100, 100, -1]]


def test_load_map_averages_colours(tmp_path: Path) -> None:
    # 255/3 = 85: p = 0.667; 510/3 = 170: p = 0.333
    assert values(tmp_path, [[[255, 0, 0], [255, 255, 0], [255, 255, 255]]]) == [[100, -1, 0]]


def test_load_map_raw_gives_the_pixels_as_signed_bytes(tmp_path: Path) -> None:
    assert values(tmp_path, [[0, 100, 127, 255, 200]], THRESHOLDS + "mode: raw\n") == [[0, 100, 127, -1, -56]]


def test_load_map_looks_palettes_up(tmp_path: Path) -> None:
    file = write_map(tmp_path, [[0]])
    image = Image.new("P", (2, 1))
    image.putpalette([255, 255, 255, 0, 0, 0])
    image.putdata([0, 1])
    image.save(tmp_path / "plan.png")
    assert load_map(file).values.tolist() == [[0, 100]]


@pytest.mark.parametrize(
    "content", [b"P5\n# made by hand\n2 1\n255\n\x00\xff", b"P2 2 1 255\n0 255\n", b"P5 2 1 65535\n\x00\x00\xff\xff"]
)
def test_load_map_reads_pgm(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "plan.pgm").write_bytes(content)
    (tmp_path / "plan.yaml").write_text(f"image: plan.pgm\n{HEAD}{THRESHOLDS}")
    assert load_map(tmp_path / "plan.yaml").values.tolist() == [[100, 0]]


def test_load_map_takes_an_absolute_image(tmp_path: Path) -> None:
    write_map(tmp_path, [[0]])
    other = tmp_path / "elsewhere"
    other.mkdir()
    (other / "map.yaml").write_text(f"image: {tmp_path / 'plan.png'}\n{HEAD}{THRESHOLDS}")
    assert load_map(other / "map.yaml").values.tolist() == [[100]]


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        (("image: plan.png\n", ""), "1:1", "image is missing"),
        (("image: plan.png", "image: no.png"), "1:8", "no.png is missing, expected an image"),
        (("image: plan.png", "image: plan.yaml"), "1:8", "not an image"),
        (("resolution: 0.05", "resolution: 0"), "2:13", "expected more than 0"),
        (("resolution: 0.05", "resolution: fine"), "2:13", "expected a number"),
        (("[1, -2.5, 0.25]", "[1, 2]"), "3:9", "expected a list of 3 numbers"),
        (("[1, -2.5, 0.25]", "[1, 2, -nan]"), "3:9", "write 0.0 where it says nan"),
        (("[1, -2.5, 0.25]", "[1, 2, .nan]"), "3:9", "write 0.0 where it says nan"),
        (("resolution: 0.05", 'resolution: "0.05 m"'), "2:13", "expected a number"),
        (("negate: 0", "negate: perhaps"), "4:9", "expected true or false"),
        (("occupied_thresh: 0.65", "occupied_thresh: 65"), "5:18", "0 to 1"),
        (("free_thresh: 0.196", "free_thresh: 0.7"), "6:14", "at most occupied_thresh, 0.65"),
        (("negate: 0", "mode: trinry\nnegate: 0"), "4:7", "expected one of trinary, scale, raw"),
        (("origin: [1, -2.5, 0.25]", "origin: [1, -2.5"), "4:7", "not valid YAML"),
    ],
)
def test_load_map_says_where_a_map_file_is_wrong(
    tmp_path: Path, change: tuple[str, str], place: str, words: str
) -> None:
    file = write_map(tmp_path, [[0]])
    file.write_text(file.read_text().replace(*change))
    with pytest.raises(UserError) as caught:
        load_map(file)
    text = str(caught.value)
    assert text.startswith(f"{file}:{place}: ")
    assert words in text + str(caught.value.diagnostics[0].help)


def test_numbers_in_quotes_are_taken_as_map_server_takes_them(tmp_path: Path) -> None:
    file = write_map(tmp_path, [[205]], 'negate: "0"\noccupied_thresh: "0.65"\nfree_thresh: 1.96e-1\n')
    plain = read_map(file)
    file.write_text(file.read_text().replace("0.05", "'5e-2'").replace("[1, -2.5, 0.25]", '["1", -2.5, "0.25"]'))
    assert read_map(file).file == plain.file
    assert plain.file.free_thresh == 0.196


def test_load_map_says_when_there_is_no_map_file(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no such file or directory, expected a map file"):
        load_map(tmp_path / "none.yaml")


def test_load_map_says_when_an_image_is_cut_short(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    file = write_map(tmp_path, rng.integers(0, 255, (50, 50)))
    whole = (tmp_path / "plan.png").read_bytes()
    (tmp_path / "plan.png").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(UserError, match=r"plan\.png cannot be read: .*expected an undamaged image"):
        load_map(file)


def test_wall_at_turns_with_the_origin(tmp_path: Path) -> None:
    path = write_map(tmp_path, [[254, 0]])
    path.write_text(path.read_text().replace("0.05", "0.1").replace("[1, -2.5, 0.25]", "[1, 2, 1.5707963267948966]"))
    image = read_map(path)
    assert image.wall_at(0.95, 2.15) is True
    assert image.wall_at(0.95, 2.05) is False
    assert image.wall_at(1.05, 2.05) is None


@pytest.mark.parametrize("content", [b"", b"no picture"])
def test_file_that_is_no_image_is_named(tmp_path: Path, content: bytes) -> None:
    path = write_map(tmp_path, [[0]])
    (tmp_path / "plan.png").write_bytes(content)
    with pytest.raises(UserError, match=r"plan.yaml:1:8: image: .*plan.png (is not an image|cannot be read)"):
        read_map(path)


def test_walls_are_only_what_is_occupied(tmp_path: Path) -> None:
    pixels = np.array([[0, 254, 205], [254, 254, 254]], np.uint8)
    assert read_map(write_map(tmp_path, pixels)).walls.tolist() == [[False, False, False], [True, False, False]]


def test_walls_compare_raw_values_with_the_threshold(tmp_path: Path) -> None:
    path = write_map(tmp_path, np.array([[0, 60, 70, 100, 255]], np.uint8), THRESHOLDS + "mode: raw\n")
    assert read_map(path).walls.tolist() == [[False, False, True, True, False]]


def test_sixteen_bit_images_are_read_as_their_upper_eight_bits(tmp_path: Path) -> None:
    path = write_map(tmp_path, [[0]])
    Image.fromarray(np.array([[0, 0xFEFF, 0x59FF]], np.uint16)).save(tmp_path / "plan.png")
    assert load_map(path).values.tolist() == [[100, 0, 100]]
    assert read_map(path).walls.tolist() == [[True, False, True]]
