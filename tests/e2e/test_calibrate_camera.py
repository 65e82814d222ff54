"""`ur run calibrate_camera` on a terminal, with a camera that is plugged in while it runs and sees a rendered board."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT, make_environment
from tests.e2e.terminal import ProgramTerminal
from tests.ur_nodes.camera.fake_device import encode

from ur_nodes.camera.calibration_file import read_calibration

pytest.importorskip("cv2")

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]
CAMERA = ROOT / "tests" / "ur_nodes" / "camera" / "fake_camera_node.py"
POSES, FILES = 3, 4  # of the board, and how often each is in the film: for 1 s each time


@contextmanager
def plugged_camera(film: Path, env: dict[str, str]) -> Iterator[None]:
    """The camera's node, which sees the board."""
    path = os.pathsep.join((str(ROOT), env.get("PYTHONPATH", "")))
    pipe = subprocess.PIPE
    with subprocess.Popen(
        [sys.executable, str(CAMERA), "1", "15", str(film), ""], env={**env, "PYTHONPATH": path}, stdin=pipe
    ) as node:
        try:
            yield
        finally:
            node.terminate()


@pytest.fixture
def film(tmp_path: Path) -> Path:
    from tests.ur_nodes.camera.calibration.rendered_board import Studio, list_poses

    from ur_nodes.camera.calibration.board import Board

    studio, folder = Studio(Board()), tmp_path / "film"
    folder.mkdir()
    for number, pose in zip(range(POSES), list_poses(), strict=False):
        picture = encode(studio.take(*pose))
        for again in range(FILES):
            (folder / f"{number}_{again}.jpg").write_bytes(picture)
    return folder


def test_screen_names_the_missing_camera_and_calibrates_the_one_that_is_plugged_in(tmp_path: Path, film: Path) -> None:
    env = make_environment(tmp_path)
    command = [str(ROOT / "ur"), "run", "calibrate_camera", "bring_up:=false", "robot_base:=magni"]
    with ProgramTerminal(command, env, columns=80) as terminal:
        terminal.wait_for("no picture on /raspicam_node/image/compressed")
        terminal.wait_for("no node publishes it")
        with plugged_camera(film, env):
            terminal.wait_for("c calibrates")  # 3 views
            terminal.type("c")
            terminal.wait_for("written to ")
            assert terminal.process.wait(60) == 0
    calibration = read_calibration(Path(env["ROS_HOME"], "camera_info", "camera.yaml"))
    assert calibration.matrix[0] == pytest.approx(540.0, rel=0.03)  # as the board was rendered


def test_q_leaves_the_screen_and_changes_nothing(tmp_path: Path, film: Path) -> None:
    env = make_environment(tmp_path)
    command = [str(ROOT / "ur"), "run", "calibrate_camera", "bring_up:=false", "robot_base:=magni"]
    with ProgramTerminal(command, env, columns=80) as terminal:
        terminal.wait_for("no node publishes it")
        with plugged_camera(film, env):
            terminal.wait_for("of the picture")  # the advice is not cut off
            terminal.type("q")
            terminal.wait_for("no calibration: ended after ")
            assert terminal.process.wait(60) != 0
    assert not list(tmp_path.rglob("camera_info"))
