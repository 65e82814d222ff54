"""The commands of docs/how-to/robot-of-your-own.md, from a description to a goal, as they are written there."""

import re
import subprocess
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT
from tests.e2e.test_programs import run_command
from tests.robot.description.urdfs import SMALL

pytestmark = [pytest.mark.ros, pytest.mark.timeout(400)]
PAGE = (ROOT / "docs" / "how-to" / "robot-of-your-own.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^( *)```(\w+)\n(.*?)^ *```$", PAGE, re.DOTALL | re.MULTILINE)
INSTALLS = "ur get "  # needs a network; tests/fresh/run tries it on an empty computer


def blocks(kind: str) -> list[str]:
    """The commands (`sh`) or outputs (`text`) of the page, in its order."""
    return [
        "".join(line.removeprefix(indent) for line in text.splitlines(True)) for indent, k, text in BLOCKS if k == kind
    ]


@pytest.fixture
def workplace(tmp_path: Path) -> Path:
    """A folder with rover.urdf, and `ur` on the PATH."""
    (tmp_path / "rover.urdf").write_text(SMALL, encoding="utf-8")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "ur").symlink_to(ROOT / "ur")
    return tmp_path


def run(workplace: Path, script: str, keys: str = "") -> subprocess.CompletedProcess[str]:
    """In bash, as a reader who types it."""
    return run_command(workplace, "bash", "-c", f'PATH="{workplace}/bin:$PATH"\n{script}', keys=keys)


def test_robot_of_the_page_is_made_read_driven_to_a_goal_and_driven_by_hand(workplace: Path) -> None:
    make, drive, install = blocks("sh")
    (notes,) = blocks("text")
    assert install.startswith(INSTALLS)
    made = run(workplace, make)
    assert made.returncode == 0, made.stderr
    assert notes in made.stderr, made.stderr
    assert "read: wheel radius 0.033 (" in made.stderr
    (file,) = re.findall(r"`~/(\S+/base\.yaml)`", PAGE)
    text = (workplace / "home" / file).read_text(encoding="utf-8")
    assert "velocity: 0.5" in text
    assert re.search(r"#.*usual", text), "the page says that usual figures are called so"
    (goal,) = re.findall(r"Type `(g .*?)`", PAGE)
    driven = run(workplace, drive, keys=f"{goal}\n")
    assert driven.stdout.startswith(f"{goal}: reached, "), driven.stderr
    assert driven.returncode == 0
    (by_hand,) = re.findall(r"`(ur run keyboard_drive .*?)`", PAGE)
    moved = run(workplace, by_hand, keys="iik")
    assert moved.returncode == 0, moved.stderr
