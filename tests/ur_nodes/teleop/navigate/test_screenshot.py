import importlib.util
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[4]


@pytest.fixture(scope="module")
def tool() -> Any:
    spec = importlib.util.spec_from_file_location("make_screenshot", ROOT / "tools/make_screenshot.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


async def test_screenshot_is_the_same_each_time_and_loads_nothing(tool: Any) -> None:
    first = await tool.take_screenshot((60, 20), False)
    assert first == await tool.take_screenshot((60, 20), False)
    assert "driving" in first
    assert "url(http" not in first


@pytest.mark.parametrize("name", ["people", "script"])
async def test_picture_is_the_one_of_the_page(tool: Any, name: str) -> None:
    made = await tool.take_screenshot((96, 32), False, name)
    found = (ROOT / f"docs/images/{name}.svg").read_text(encoding="utf-8")
    assert made == found, f"run tools/make_screenshot.py {name}"


def test_committed_screenshot_is_small() -> None:
    assert 10_000 < (ROOT / "docs/images/keyboard_navigate.svg").stat().st_size < 150_000
