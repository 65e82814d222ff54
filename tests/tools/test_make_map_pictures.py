"""The pictures of the page on maps: the page shows each of them, and what the tool makes is what is committed."""

import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]
TOOL = ROOT / "tools" / "make_map_pictures.py"
IMAGES = ROOT / "docs" / "images"
PAGE = ROOT / "docs" / "how-to" / "make-a-map.md"


@pytest.fixture(scope="module")
def tool() -> dict[str, Any]:
    return runpy.run_path(str(TOOL))


def test_page_shows_every_picture_and_only_those(tool: dict[str, Any]) -> None:
    shown = set(re.findall(r"\.\./images/(\S+\.(?:png|svg))\)", PAGE.read_text(encoding="utf-8")))
    of_terminals = {"lost"}  # by tools/make_screenshot.py
    assert {Path(name).stem for name in shown} - of_terminals == set(tool["PICTURES"])
    assert all((IMAGES / name).is_file() for name in shown)


def test_unknown_picture_gets_one_line(tool: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    assert tool["main"](["grows"]) == 2
    assert (
        capsys.readouterr().err == "error: 'grows' is not known, expected one of map_grows, map_spoiled, map_explored\n"
    )


def test_spoiled_map_is_as_it_is_pictured(tool: dict[str, Any]) -> None:
    made = np.asarray(tool["make_map_spoiled"]().convert("L")).astype(int)
    committed = np.asarray(Image.open(IMAGES / "map_spoiled.png").convert("L")).astype(int)
    assert made.shape == committed.shape
    # Another release of gtsam or numpy rounds a little differently.
    assert (abs(made - committed) > 40).mean() < 0.02, "run tools/make_map_pictures.py"


def test_end_of_an_exploration_is_as_it_is_pictured(tool: dict[str, Any]) -> None:
    made, committed = tool["make_map_explored"](), (IMAGES / "map_explored.svg").read_text(encoding="utf-8")
    assert made == committed, "run tools/make_map_pictures.py"
