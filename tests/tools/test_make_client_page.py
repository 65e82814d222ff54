"""The page of the Python library is that of its docstrings."""

import runpy
from pathlib import Path

TOOL = runpy.run_path(str(Path(__file__).parents[2] / "tools" / "make_client_page.py"))


def test_page_is_that_of_the_docstrings() -> None:
    assert TOOL["PAGE"].read_text(encoding="utf-8") == TOOL["make_page"](), "run tools/make_client_page.py"
