"""Fiducials mapped with the pictures of raspicam_node: its camera sees what the simulator renders."""

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.ros_session import RosSession
from tests.ur_nodes.simulator.renderer import needs_renderer

from ur.robot.base import load_base
from ur.worlds.world_file import read_world
from ur_nodes.camera.calibration_file import write_calibration
from ur_nodes.ports.values import Calibration

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "ubiquity_launches"
WORLD = PACKAGE / "n_simulator" / "worlds" / "office.yaml"
FAKE = str(Path(__file__).with_name("fake_camera_node.py"))
CLIENT = str(ROOT / "tests" / "ur_nodes" / "vision" / "client_node.py")
SEEN = "rendered"  # the namespace of the simulated camera
WIDTH, HEIGHT = 640, 480

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]


def write_camera_info(path: Path) -> None:
    """The calibration of Magni's simulated camera."""
    camera = load_base(PACKAGE, "magni", "").raspicam
    assert camera is not None
    f = WIDTH / 2.0 / math.tan(camera.field_of_view / 2.0)
    x, y = (WIDTH - 1) / 2.0, (HEIGHT - 1) / 2.0
    matrix = (f, 0.0, x, 0.0, f, y, 0.0, 0.0, 1.0)
    square = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    projection = (f, 0.0, x, 0.0, 0.0, f, y, 0.0, 0.0, 0.0, 1.0, 0.0)
    found = Calibration(0, "", WIDTH, HEIGHT, "plumb_bob", (0.0,) * 5, matrix, square, projection)
    write_calibration(path, found, "camera")


def test_fiducial_slam_maps_with_the_pictures_of_a_real_camera(tmp_path: Path) -> None:
    needs_renderer()
    write_camera_info(tmp_path / "camera.yaml")
    moved = [f"raspicam_node/{topic}:={SEEN}/{topic}" for topic in ("image/compressed", "image_raw", "camera_info")]
    ros = RosSession(tmp_path)
    try:
        size = (f"_camera_width:={WIDTH}", f"_camera_height:={HEIGHT}", "_camera_rate:=4.0")
        simulator = str(PACKAGE / "n_simulator" / "bin" / "simulator")
        ros.start(simulator, "_base:=magni", f"_world_file:={WORLD}", *size, *moved)
        url = f"_camera_info_url:=file://{tmp_path / 'camera.yaml'}"
        ros.start(sys.executable, FAKE, "1", "0", "", f"/{SEEN}/image/compressed", "__name:=raspicam_node", url)
        camera = ("camera/compressed:=raspicam_node/image/compressed", "camera_info:=raspicam_node/camera_info")
        ros.start(str(PACKAGE / "n_fiducial_detect" / "bin" / "aruco_detect"), "_fiducial_len:=0.3", *camera)
        slam = str(PACKAGE / "n_fiducial_slam" / "bin" / "fiducial_slam")
        ros.start(slam, "_fiducial_len:=0.3", f"_map_file:={tmp_path / 'map.txt'}", "_initial_pose_x:=0.0", camera[1])
        client = ros.start(sys.executable, CLIENT, "fiducials,fiducial_map,fiducial_pose")
        out, errors = client.communicate(timeout=400)
        ros.running.remove(client)
    finally:
        ros.close()
    assert client.returncode == 0, errors
    seen = json.loads(out)
    assert seen["complete"], sorted(seen)
    truth = {each.id: np.array(each.pose[:3]) for each in read_world(WORLD).fiducials}
    for number, place in seen["fiducial_map"].items():
        assert np.linalg.norm(np.array(place) - truth[int(number)]) < 0.25
