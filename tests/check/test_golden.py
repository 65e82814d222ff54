"""The thirteen ordinary mistakes, as `ur check` reports them: compared letter by letter.

`UR_UPDATE_GOLDEN=1` writes the expected texts anew. The launch files are those that the resolver's goldens use.
"""

import os
from pathlib import Path

import pytest

from ur.check.render.text import shorten_paths
from ur.check.session import CheckReport, check_paths
from ur.launchfile.world.system import SystemWorld
from ur.source.render import render_human

INPUTS = Path(__file__).parents[1] / "launchfile" / "golden"
GOLDEN = Path(__file__).parent / "golden"
THE_THIRTEEN = sorted(path for path in (INPUTS / "err").iterdir() if path.name[:2].isdigit())


def check(case: Path) -> CheckReport:
    words = case / "arguments.txt"
    arguments = dict(word.split(":=") for word in words.read_text().split()) if words.exists() else {}
    world = SystemWorld({"ROS_PACKAGE_PATH": str(INPUTS), "HOME": "/home/robot"})
    return shorten_paths(check_paths([str(case)], world, None, arguments), str(case))


@pytest.mark.parametrize("case", THE_THIRTEEN, ids=lambda case: case.name)
def test_report_of_a_mistake_is_as_agreed(case: Path) -> None:
    report = render_human(check(case).findings).replace(str(INPUTS), "GOLDEN")
    expected = GOLDEN / f"{case.name}.txt"
    if os.environ.get("UR_UPDATE_GOLDEN"):
        expected.write_text(report, encoding="utf-8")
    assert report == expected.read_text(encoding="utf-8")


@pytest.mark.parametrize("case", THE_THIRTEEN, ids=lambda case: case.name)
def test_each_ordinary_mistake_is_an_error_with_a_place_and_help(case: Path) -> None:
    report = check(case)
    assert report.errors >= 1
    for found in report.findings:
        assert found.span is not None
        assert found.help
    if (case / "middle.launch.xml").exists():
        steps = [
            note.span.file.path
            for note in report.findings[0].notes
            if note.message == "included from here" and note.span
        ]
        assert steps == ["middle.launch.xml", "main.launch"]


def test_there_are_thirteen() -> None:
    assert len(THE_THIRTEEN) == 13
