"""The pictures of bases: one for each look, and what RViz shows is what is committed."""

import runpy
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]
TOOL = ROOT / "tools" / "make_base_pictures.py"
PICTURES = ROOT / "docs" / "images" / "bases"


@pytest.fixture(scope="module")
def tool() -> dict[str, Any]:
    return runpy.run_path(str(TOOL))


def run_tool(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, str(TOOL), *arguments], capture_output=True, text=True, check=False)


def needs_rviz() -> None:
    for program in ("rviz", "Xvfb", "rosmaster"):
        if not shutil.which(program):
            pytest.skip(f"{program} is not installed: apt-get install rviz xvfb")


def test_every_look_has_its_picture_and_only_those(tool: dict[str, Any]) -> None:
    assert {path.stem for path in PICTURES.iterdir()} == set(tool["list_looks"]())


def test_small_base_is_seen_from_nearer(tool: dict[str, Any]) -> None:
    looks = tool["list_looks"]()
    distance = {
        name: tool["make_config"](looks[name], {})["Visualization Manager"]["Views"]["Current"]["Distance"]
        for name in ("loki", "magni")
    }
    assert distance["loki"] < 0.6 * distance["magni"]


def test_unknown_base_gets_one_line(tmp_path: Path) -> None:
    needs_rviz()
    done = run_tool("--only", "lokki", str(tmp_path))
    assert done.returncode == 2
    assert done.stdout.startswith("error: lokki is not known, expected one of botvac")


@pytest.mark.ros
@pytest.mark.timeout(400)
def test_rviz_shows_a_base_as_it_is_pictured(tmp_path: Path) -> None:
    needs_rviz()
    done = run_tool("--only", "botvac.xv11", str(tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    made, committed = (
        np.asarray(Image.open(folder / "botvac.xv11.png").convert("RGB")).astype(int) for folder in (tmp_path, PICTURES)
    )
    assert made.shape == committed.shape
    # Another release of Mesa draws edges a little differently.
    assert (abs(made - committed).max(axis=2) > 40).mean() < 0.02, "run tools/make_base_pictures.py"
