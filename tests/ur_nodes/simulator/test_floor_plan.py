from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ur.source.diagnostic import UserError
from ur.worlds.floor_plan import read_floor_plan

KEYS = "resolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"


def write(folder: Path, pixels: np.ndarray, keys: str = KEYS, name: str = "plan.png") -> Path:
    Image.fromarray(pixels).save(folder / name)
    (folder / "plan.yaml").write_text(f"image: {name}\n{keys}")
    return folder / "plan.yaml"


def test_floor_plan_rows_go_up_from_the_bottom(tmp_path: Path) -> None:
    plan = read_floor_plan(write(tmp_path, np.array([[0, 254, 205], [254, 254, 254]], np.uint8)))
    assert plan.occupied.tolist() == [[False, False, False], [True, False, False]]


@pytest.mark.parametrize("name", ["plan.png", "plan.pgm"])
def test_floor_plan_formats_read_the_same(tmp_path: Path, name: str) -> None:
    plan = read_floor_plan(write(tmp_path, np.array([[0, 254]], np.uint8), name=name))
    assert plan.occupied.tolist() == [[True, False]]


def test_floor_plan_negate_swaps_black_and_white(tmp_path: Path) -> None:
    path = write(tmp_path, np.array([[0, 254]], np.uint8), KEYS.replace("negate: 0", "negate: 1"))
    assert read_floor_plan(path).occupied.tolist() == [[False, True]]


def test_floor_plan_channels_are_averaged(tmp_path: Path) -> None:
    pixels = np.array([[[0, 0, 0], [255, 0, 0], [255, 255, 0]]], np.uint8)
    assert read_floor_plan(write(tmp_path, pixels)).occupied.tolist() == [[True, True, False]]


def test_floor_plan_raw_values_above_the_threshold_are_occupied(tmp_path: Path) -> None:
    path = write(tmp_path, np.array([[0, 60, 70, 100, 255]], np.uint8), KEYS + "mode: raw\n")
    assert read_floor_plan(path).occupied.tolist() == [[False, False, True, True, False]]


def test_floor_plan_origin_turns_the_grid(tmp_path: Path) -> None:
    path = write(tmp_path, np.array([[254, 0]], np.uint8), KEYS.replace("[0, 0, 0]", "[1.0, 2.0, 1.5707963267948966]"))
    plan = read_floor_plan(path)
    assert plan.is_occupied(0.95, 2.15)
    assert not plan.is_occupied(0.95, 2.05)
    assert not plan.contains(1.05, 2.05)


def test_floor_plan_missing_image_is_named_with_its_line(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text("image: gone.png\n" + KEYS)
    with pytest.raises(UserError, match=r"plan.yaml:1:8: image: .*gone.png is missing"):
        read_floor_plan(tmp_path / "plan.yaml")


@pytest.mark.parametrize("content", [b"", b"no picture", None])
def test_floor_plan_damaged_image_is_named(tmp_path: Path, content: bytes | None) -> None:
    path = write(tmp_path, np.random.default_rng(0).integers(0, 255, (40, 40), np.uint8))
    image = tmp_path / "plan.png"
    image.write_bytes(image.read_bytes()[:400] if content is None else content)
    with pytest.raises(UserError, match=r"plan.png (is not an image|cannot be read)"):
        read_floor_plan(path)


def test_floor_plan_missing_key_is_named(tmp_path: Path) -> None:
    path = write(tmp_path, np.zeros((2, 2), np.uint8), KEYS.replace("resolution: 0.1\n", ""))
    with pytest.raises(UserError, match="resolution is missing"):
        read_floor_plan(path)
