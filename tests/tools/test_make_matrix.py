"""The page of programs is what programs, bases and the table of expectations make."""

import runpy
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_committed_page_is_what_programs_and_bases_say() -> None:
    tool = runpy.run_path(str(ROOT / "tools" / "make_matrix.py"))
    committed = tool["PAGE"].read_text(encoding="utf-8")
    assert committed == tool["make_page"](), "run tools/make_matrix.py"
