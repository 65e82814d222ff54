"""The page on architecture and those below it name packages, imports, modules and files as they are."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SRC = ROOT / "src"
PAGE = ROOT / "docs" / "architecture.md"
READMES = sorted(SRC.rglob("README.md"))
PAGES = (
    PAGE,
    *(ROOT / "docs" / each for each in ("reference/launch-library.md", "explain/own-code.md")),
    *READMES,
)
_CODE = re.compile(r"`([^`\n]+)`")
_LINK = re.compile(r"\]\(([^)#\s]+)")
TEXT = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)


def section(heading: str) -> str:
    return PAGE.read_text(encoding="utf-8").partition(f"\n## {heading}\n")[2].partition("\n## ")[0]


def test_the_page_is_read_in_ten_minutes() -> None:
    assert len(PAGE.read_text(encoding="utf-8").splitlines()) <= 120, "expected details in the README of their package"


def test_the_page_leads_to_the_readme_of_each_package_that_has_one() -> None:
    named = {(PAGE.parent / target).resolve() for target in _LINK.findall(PAGE.read_text(encoding="utf-8"))}
    assert {*PAGES[1:]} <= named


@pytest.mark.parametrize(
    "name", sorted({each for each in _CODE.findall(TEXT) if re.fullmatch(r"ur(_nodes)?\.\S+", each)})
)
def test_modules_and_what_is_in_them_exist(name: str) -> None:
    *above, last = name.split(".")
    folder = SRC.joinpath(*above)
    if (folder / last).is_dir() or (folder / f"{last}.py").is_file():
        return
    files = [folder.with_suffix(".py"), *folder.glob("*.py")]
    defined = re.compile(rf"^(?:def|class) {last}\b|^{last}\b.*=|import .*\b{last}\b|^    \"{last}\"", re.MULTILINE)
    assert any(defined.search(file.read_text(encoding="utf-8")) for file in files if file.is_file()), name


def test_files_of_changes_exist() -> None:
    for line in section("Where to make a change").splitlines():
        for path in _CODE.findall(line):
            if path.startswith(("src/", "tools/", "tests/", "ubiquity_launches/")) and "NAME" not in path:
                assert (ROOT / path).exists(), path
