"""~/.ros_setup in the shells that read it: what is found, and what catkin fills in that nobody chose."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from ur.robot.setup.environment import robot_setup_text, viewer_environment
from ur.robot.setup.wanted import WantedFile

SHELLS = [shell for shell in ("dash", "bash", "zsh") if shutil.which(shell)]
# As catkin and roslaunch write it into a workspace that was built.
DEVEL = 'export ROS_PACKAGE_PATH="$HOME/catkin_ws/src"\n[ "$ROS_MASTER_URI" ] || export ROS_MASTER_URI=http://localhost:11311\n'
SHOW = '; . "$HOME/.ros_setup"; echo "$ROS_PACKAGE_PATH|${ROS_MASTER_URI-unset}|${PATH%%:*}"'


def show(shell: str, home: Path, text: str, **environment: str) -> list[str]:
    (home / ".ros_setup").write_text(text)
    words = [shell, "-c", f'set -u; . "$HOME/.ros_setup"{SHOW}']
    whole = {"HOME": str(home), "PATH": os.defpath.lstrip(":"), **environment}
    done = subprocess.run(words, env=whole, capture_output=True, text=True, check=True, timeout=60)
    assert done.stderr == ""
    return done.stdout.rstrip("\n").split("|")


def viewer_text(repository: Path) -> str:
    (item,) = (each for each in viewer_environment(repository) if isinstance(each, WantedFile))
    return item.text


@pytest.mark.parametrize("shell", SHELLS)
def test_workspace_is_found_before_it_is_built_and_nothing_is_doubled(shell: str, tmp_path: Path) -> None:
    packages, master, _ = show(shell, tmp_path, viewer_text(tmp_path / "none"))
    assert packages == f"{tmp_path}/catkin_ws/src:/usr/share"
    assert master == "unset"
    packages, _, _ = show(shell, tmp_path, viewer_text(tmp_path / "none"), ROS_PACKAGE_PATH="/opt/mine:/usr/share")
    assert packages == f"{tmp_path}/catkin_ws/src:/opt/mine:/usr/share"


@pytest.mark.parametrize("shell", SHELLS)
def test_built_workspace_does_not_choose_the_master(shell: str, tmp_path: Path) -> None:
    (tmp_path / "catkin_ws/devel").mkdir(parents=True)
    (tmp_path / "catkin_ws/devel/setup.sh").write_text(DEVEL.replace('"$ROS_MASTER_URI"', '"${ROS_MASTER_URI-}"'))
    packages, master, _ = show(shell, tmp_path, viewer_text(tmp_path / "none"))
    assert packages == f"{tmp_path}/catkin_ws/src:/usr/share"
    assert master == "unset"
    assert show(shell, tmp_path, viewer_text(tmp_path / "none"), ROS_MASTER_URI="http://mine:1")[1] == "http://mine:1"


@pytest.mark.parametrize("shell", SHELLS)
def test_robot_has_a_master_of_its_own_and_finds_its_copy_of_this_project(shell: str, tmp_path: Path) -> None:
    (tmp_path / "ubiquity_launches/ubiquity_launches/bin").mkdir(parents=True)
    packages, master, first = show(shell, tmp_path, robot_setup_text())
    library = f"{tmp_path}/ubiquity_launches/ubiquity_launches"
    assert packages == f"{library}:{tmp_path}/catkin_ws/src:/usr/share"
    assert first == f"{library}/bin"
    assert master == f"http://{os.uname().nodename.split('.')[0]}.local:11311"
