"""The page of bases is the one that the base files make."""

import re
import runpy
from pathlib import Path
from typing import Any

import pytest

from ur.robot.base import SENSORS, list_bases, read_base

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def tool() -> dict[str, Any]:
    return runpy.run_path(str(ROOT / "tools" / "make_base_page.py"))


def test_committed_page_is_what_the_base_files_say(tool: dict[str, Any]) -> None:
    assert tool["PAGE"].read_text(encoding="utf-8") == tool["make_page"](), "run tools/make_base_page.py"


def test_how_to_shows_the_example_of_every_sensor(tool: dict[str, Any]) -> None:
    page = tool["EXPLAINED"].read_text(encoding="utf-8")
    assert page == tool["explain_sensors"](page), "run tools/make_base_page.py"


def test_every_base_is_pictured_and_no_picture_is_left_over(tool: dict[str, Any]) -> None:
    text = tool["PAGE"].read_text(encoding="utf-8")
    linked = set(re.findall(r"\.\./images/bases/(\S+\.png)", text))
    pictures = {path.name: path for path in (ROOT / "docs" / "images" / "bases").iterdir()}
    assert linked == set(pictures)
    assert {name.split(".")[0] for name in linked} == set(list_bases(ROOT / "ubiquity_launches"))
    assert all(path.stat().st_size < 60_000 for path in pictures.values())


def test_base_without_a_picture_or_a_driver_is_on_the_page_too(tool: dict[str, Any], tmp_path: Path) -> None:
    folder = tmp_path / "bases" / "mine"
    folder.mkdir(parents=True)
    stage = (ROOT / "ubiquity_launches" / "bases" / "stage" / "base.yaml").read_text(encoding="utf-8")
    (folder / "base.yaml").write_text(stage[: stage.index("sensors:")], encoding="utf-8")
    page = tool["make_page"](tmp_path)
    assert "| `mine` | A plain round-cornered robot" in page
    assert "It is only ever simulated" in page
    assert "png" not in page
    assert "lidar |" not in page.split("## mine")[1]


def test_example_of_the_how_to_is_a_good_base_file(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "how-to" / "describe-a-base.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```yaml\n(.*?)```", page, flags=re.DOTALL)
    path = tmp_path / "base.yaml"
    path.write_text(example, encoding="utf-8")
    base = read_base(path, "mower", "blind")
    assert base.lidar is None
    for part in (*SENSORS, "driver", "drivers"):
        assert getattr(read_base(path, "mower"), part), f"the example shows {part}"
