"""Built and installed with Debian's catkin: the installed copy is found, and it runs."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ros_session import ROOT, RosSession

from ur.cli.main import main

pytestmark = [
    pytest.mark.ros,
    pytest.mark.skipif(
        not all(map(shutil.which, ("catkin_make", "cmake", "make"))), reason="catkin, cmake or make is not installed"
    ),
]
SYSTEM = {"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8"}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that holds our package and one made with `ur new`, built and installed."""
    folder = tmp_path_factory.mktemp("workspace")
    (folder / "src").mkdir()
    (folder / "src" / "ubiquity_launches").symlink_to(ROOT / "ubiquity_launches")
    before = Path.cwd()
    os.chdir(folder / "src")
    try:
        assert main(["new", "package", "mine", "--summary", "s", "--maintainer", "A", "--email", "a@b.invalid"]) == 0
        words = ["--package", "mine", "--summary", "A map.", "--include", "n_map_server"]
        assert main(["new", "multi", "map", *words]) == 0
        assert main(["check", "--package", "mine"]) == 1
        assert main(["check", "--package", "--fix", "mine"]) == 0
        assert main(["check", "--package", "mine"]) == 0
    finally:
        os.chdir(before)
    done = subprocess.run(
        ["catkin_make", "install"],
        cwd=folder,
        env={**SYSTEM, "HOME": str(folder)},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return folder


@pytest.fixture
def session(workspace: Path, tmp_path: Path) -> Iterator[RosSession]:
    started = RosSession(tmp_path)
    started.env |= {"ROS_PACKAGE_PATH": f"{workspace}/install/share:/usr/share", **SYSTEM}
    yield started
    started.close()


def run(session: RosSession, *command: str) -> str:
    done = subprocess.run(command, env=session.env, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_everything_that_launch_files_need_is_installed(workspace: Path) -> None:
    installed = workspace / "install" / "share"
    assert (installed / "mine" / "m_map" / "launch" / "m_map.launch.xml").is_file()
    assert os.access(installed / "mine" / "bin" / "ur_map", os.X_OK)
    dead = [path for path in installed.rglob("*") if path.is_symlink() and not path.exists()]
    assert not dead
    ours = installed / "ubiquity_launches"
    for path in (ROOT / "ubiquity_launches").rglob("*.launch.xml"):
        assert (ours / path.relative_to(ROOT / "ubiquity_launches")).is_file()


def test_installed_nodes_run_under_plain_roslaunch(session: RosSession, workspace: Path) -> None:
    assert run(session, "rospack", "find", "mine").strip() == f"{workspace}/install/share/mine"
    maze = "/n_map_server/maps/maze.yaml"
    launch = session.start(
        "/usr/bin/roslaunch", "mine", "m_map.launch.xml", f"map_file:={workspace}/install/share/ubiquity_launches{maze}"
    )
    session_uri = ["/usr/bin/python3", "-c", WAIT]
    assert run(session, *session_uri).strip() == "map"
    session.stop(launch)


def test_installed_ur_is_the_repository_s(workspace: Path, session: RosSession) -> None:
    assert run(session, str(workspace / "install/share/ubiquity_launches/bin/ur"), "--version").startswith("ur ")


WAIT = """
import rospy
from nav_msgs.msg import OccupancyGrid
import os, sys
answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
rospy.init_node("reader", anonymous=True)
assert rospy.wait_for_message("map", OccupancyGrid, timeout=90).info.width > 0
answers.write("map")
answers.close()
"""
