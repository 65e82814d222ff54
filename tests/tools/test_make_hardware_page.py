"""The page of robots and sensors is the one that the table makes."""

import runpy
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_committed_page_is_what_the_table_says() -> None:
    tool = runpy.run_path(str(ROOT / "tools" / "make_hardware_page.py"))
    assert tool["PAGE"].read_text(encoding="utf-8") == tool["make_page"](), "run tools/make_hardware_page.py"
