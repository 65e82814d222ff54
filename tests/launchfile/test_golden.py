"""What a user reads about every mistake: compared letter by letter. `UR_UPDATE_GOLDEN=1` writes them anew."""

import os
from pathlib import Path

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.executables import check_executables
from ur.launchfile.world.system import SystemWorld
from ur.source import render_human

GOLDEN = Path(__file__).parent / "golden"
CASES = sorted(path.parent for path in GOLDEN.glob("*/*/main.launch"))
THE_THIRTEEN = [path for path in CASES if path.name[:2].isdigit()]


def _report(case: Path) -> str:
    words = case / "arguments.txt"
    arguments = words.read_text().split() if words.exists() else []
    world = SystemWorld({"ROS_PACKAGE_PATH": str(GOLDEN), "HOME": "/home/robot"})
    plan = load_plan(["main.launch"], arguments, world)
    found = plan.diagnostics
    if "executable" in case.name or case.parent.name == "ok":
        found += check_executables(plan, world)
    return render_human(found).replace(str(GOLDEN), "GOLDEN")


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.parent.name}-{case.name}")
def test_report_is_as_agreed(case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(case)
    report = _report(case)
    expected = case / "expected.txt"
    if os.environ.get("UR_UPDATE_GOLDEN"):
        expected.write_text(report)
    assert report == (expected.read_text() if expected.exists() else "")


@pytest.mark.parametrize("case", THE_THIRTEEN, ids=lambda case: case.name)
def test_each_ordinary_mistake_gets_a_place_and_help(case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(case)
    lines = _report(case).splitlines()
    assert lines[0].split(":")[0].endswith((".launch", ".xml", "<command line>"))
    assert all(part.isdigit() for part in lines[0].split(":")[1:3])
    assert any(line.startswith("  help: ") for line in lines)
    if (case / "middle.launch.xml").exists():
        assert [line.split(":")[1].strip() for line in lines if line.endswith("included from here")] == [
            "middle.launch.xml",
            "main.launch",
        ]


def test_there_are_thirteen() -> None:
    assert len(THE_THIRTEEN) == 13
