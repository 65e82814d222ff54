"""The page on architecture names packages, imports, modules and files as they are."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from tests.test_layers import MAY_IMPORT

ROOT = Path(__file__).parents[2]
SRC = ROOT / "src"
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
_CODE = re.compile(r"`([^`\n]+)`")
NAMES = sorted({each for each in _CODE.findall(PAGE) if re.fullmatch(r"ur(_nodes)?\.\S+", each)})


def section(heading: str) -> str:
    return PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]


def test_table_holds_the_packages_and_imports_that_are_enforced() -> None:
    rows = [line.split(" | ") for line in section("Stages and packages").splitlines() if line.startswith("| `")]
    table = {row[0].strip("| `"): tuple(_CODE.findall(row[-1])) for row in rows}
    assert table == MAY_IMPORT


@pytest.mark.parametrize(
    "name", sorted({each for each in _CODE.findall(PAGE) if re.fullmatch(r"ur(_nodes)?\.\S+", each)})
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
