"""The commands of the page about uninstalling leave nothing of the project in a home folder."""

import os
import re
import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "how-to" / "uninstall.md").read_text(encoding="utf-8")


@pytest.fixture
def own(tmp_path: Path) -> dict[str, str]:
    """The environment of a user with an empty home folder."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("XDG_", "ROS_", "UR_"))}
    return {**kept, "HOME": str(tmp_path), "PATH": f"{ROOT}:{os.environ['PATH']}"}


def run(command: str, own: Mapping[str, str]) -> str:
    done = subprocess.run(
        ["bash", "-c", command], cwd=own["HOME"], env=own, stdin=subprocess.DEVNULL, capture_output=True, check=False
    )
    text = (done.stdout + done.stderr).decode()
    assert done.returncode == 0, f"{command}:\n{text}"
    return text


def commands_below(heading: str) -> list[str]:
    section = PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    return [line for block in re.findall(r"```bash\n(.*?)```", section, re.DOTALL) for line in block.splitlines()]


def test_nothing_of_the_project_stays_in_the_home_folder(tmp_path: Path, own: dict[str, str]) -> None:
    (tmp_path / ".bashrc").write_text("alias ll='ls -l'\n")
    run("ur setup --only-mine --yes", own)
    run("ur use sim:magni:lidar", own)
    (tmp_path / ".ros" / "log").mkdir(parents=True)
    (tmp_path / ".local/share/ubiquity_launches/waypoints").mkdir(parents=True)
    assert "ros_setup" in (tmp_path / ".bashrc").read_text()

    undo = commands_below("2. Take the set-up of this computer back")
    assert undo == ["ur setup --undo"]
    run(f"{undo[0]} --only-mine", own)  # the computer's own settings are not for a test to change
    for command in commands_below("5. Remove what it has remembered"):
        run(command, own)

    left = [str(path.relative_to(tmp_path)) for path in sorted(tmp_path.rglob("*")) if path.is_file()]
    assert left == [".bashrc", ".ssh/id_ed25519", ".ssh/id_ed25519.pub"]
    assert (tmp_path / ".bashrc").read_text() == "alias ll='ls -l'\n"
    assert not [path for path in tmp_path.rglob("*") if "ubiquity" in path.name]


def test_lines_of_a_robot_are_removed_from_its_shell_files(tmp_path: Path, own: dict[str, str]) -> None:
    for name in (".bashrc", ".profile", ".zshenv"):
        (tmp_path / name).write_text("export A=1\n")
    run("ur setup --only-mine --yes", own)
    here = [each for each in commands_below("A robot") if not each.startswith(("ur ", "sudo "))]
    assert len(here) == 2
    for command in here:
        run(command, own)
    for name in (".bashrc", ".profile", ".zshenv"):
        assert (tmp_path / name).read_text() == "export A=1\n"
    assert not (tmp_path / ".ros_setup").exists()
