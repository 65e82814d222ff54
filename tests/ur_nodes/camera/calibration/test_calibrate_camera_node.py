"""The whole calibration over real ROS: a camera that sees a rendered board, its node, and the program."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from tests.ros_session import RosSession
from tests.ur_nodes.camera.calibration.rendered_board import MATRIX, Studio, list_poses
from tests.ur_nodes.camera.fake_device import encode

from ur_nodes.camera.calibration.board import Board
from ur_nodes.camera.calibration_file import read_calibration

FAKE = str(Path(__file__).parents[1] / "fake_camera_node.py")
NODE = (sys.executable, "-m", "ur_nodes", "ur_nodes.camera.calibration.calibrate_camera_node")
pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]


@pytest.mark.long
def test_camera_is_calibrated_from_what_it_sees_and_its_node_keeps_the_result(tmp_path: Path) -> None:
    studio = Studio(Board())
    (tmp_path / "film").mkdir()
    for number, (rotation, translation) in enumerate(list_poses()):
        (tmp_path / "film" / f"{number:02}.jpg").write_bytes(encode(studio.take(rotation, translation)))
    ros = RosSession(tmp_path)
    try:
        ros.start(sys.executable, FAKE, "1", "15", str(tmp_path / "film"), "")
        program = ros.start(*NODE)
        out, errors = program.communicate(timeout=500)
        ros.running.remove(program)
    finally:
        ros.close()
    assert program.returncode == 0, out + errors
    path = tmp_path / "camera_info" / "camera.yaml"
    assert out.splitlines()[-1] == f"written to {path}"
    calibration = read_calibration(path)
    assert calibration.camera_matrix[0] == pytest.approx(MATRIX[0, 0], rel=0.01)
    assert calibration.camera_matrix[4] == pytest.approx(MATRIX[1, 1], rel=0.01)
    assert "reprojection error 0." in out


def test_without_a_camera_the_program_says_so_and_ends_with_q(tmp_path: Path) -> None:
    ros = RosSession(tmp_path)
    try:
        program = ros.start(*NODE, "_camera:=left")
        assert program.stdout
        assert program.stdin
        line = program.stdout.readline()
        while "no node publishes it" not in line:
            assert "views" in line or line.startswith("no picture on /left/image/compressed"), line
            line = program.stdout.readline()
        program.stdin.write("q\n")
        program.stdin.flush()
        out, errors = program.communicate(timeout=60)
        ros.running.remove(program)
    finally:
        ros.close()
    assert (program.returncode, errors) == (1, "")
    assert "nothing was changed" in out
