"""The committed texts about releases are what the table says."""

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TOOL = runpy.run_path(str(ROOT / "tools" / "make_releases_page.py"))


def test_committed_page_is_what_the_table_says() -> None:
    assert TOOL["PAGE"].read_text(encoding="utf-8") == TOOL["make_page"](), "run tools/make_releases_page.py"


def test_readme_says_what_the_table_says() -> None:
    text = TOOL["README"].read_text(encoding="utf-8")
    assert TOOL["replace_table"](text, TOOL["make_table"]()) == text, "run tools/make_releases_page.py"


def test_text_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="expected the marks"):
        TOOL["replace_table"]("# A text\n", "It runs.")


@pytest.mark.parametrize(
    "page", ["docs/tutorial.md", "docs/how-to/prepare-an-image.md", "docs/how-to/set-up-a-robot.md"]
)
def test_page_that_names_systems_points_to_the_table(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    assert "reference/releases.md" in text
    assert "ubuntu-24.04" not in text
    assert "22.04 and later" not in text
