import io
import math
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import psutil
import pytest
from PIL import Image
from tests.ur_nodes.simulator.conftest import MakeWorld
from tests.ur_nodes.simulator.renderer import needs_renderer

from ur.robot.base import Base
from ur.source.diagnostic import UserError
from ur_nodes.simulator.camera.camera_process import CameraProcess
from ur_nodes.simulator.scenery import draw_textures
from ur_nodes.simulator.simulation import Simulation

# A plate on the wall that the robot faces, 5 m ahead, and the camera looking straight at its height.
PLATE = "fiducials:\n  size: 0.5\n  places:\n    - {id: 3, pose: [4.99, 0.0, 0.5, 1.5707963, 0.0, -1.5707963]}\n"


def look(magni: Base) -> Base:
    assert magni.raspicam
    camera = replace(magni.raspicam, pose=(0.0, 0.0, 0.5, 0.0, 0.0, 0.0), width=320, height=240)
    return replace(magni, raspicam=camera)


def test_picture_shows_a_fiducial_where_the_camera_model_projects_it(magni: Base, make_world: MakeWorld) -> None:
    needs_renderer()
    cv2 = pytest.importorskip("cv2", reason="OpenCV is not installed: requirements/vision.lock")
    base, world = look(magni), make_world(PLATE)
    assert base.raspicam
    process = CameraProcess(world, base, base.raspicam, 1)
    try:
        picture = process.render(0, Simulation(world, base).state(), pixels=True, jpeg=True)
    finally:
        process.close()
    image = np.frombuffer(picture.pixels, np.uint8).reshape(240, 320, 3)
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_1000)
    corners, ids, _ = cv2.aruco.ArucoDetector(dictionary).detectMarkers(image)
    assert ids.ravel().tolist() == [3]
    half = 0.25 / 4.99 * base.raspicam.focal_length
    square = np.array([[-half, -half], [half, -half], [half, half], [-half, half]]) + np.array([159.5, 119.5])
    assert np.abs(corners[0][0] - square).max() < 1.0  # first corner top left: neither turned nor mirrored
    jpeg = np.asarray(Image.open(io.BytesIO(picture.jpeg)), float)
    assert np.abs(jpeg - image).mean() < 4.0


def test_picture_turns_with_the_robot(magni: Base, make_world: MakeWorld) -> None:
    needs_renderer()
    world = make_world("boxes:\n  - {name: dark, pose: [0.0, 1.9, 1.0, 0.0], size: [1.0, 0.1, 2.0]}\n")
    base = look(magni)
    assert base.raspicam
    simulation = Simulation(world, base)
    process = CameraProcess(world, base, base.raspicam, 1)
    try:
        ahead = process.render(0, simulation.state(), pixels=True, jpeg=False)
        simulation.set_pose("robot", (0.0, 0.0, math.pi / 2))
        left = process.render(0, simulation.state(), pixels=True, jpeg=False)
    finally:
        process.close()
    assert ahead.jpeg == b""
    assert np.abs(np.frombuffer(ahead.pixels, np.uint8).astype(int) - np.frombuffer(left.pixels, np.uint8)).mean() > 5.0


def test_process_keeps_no_code_that_compiled_what_draws(magni: Base, make_world: MakeWorld) -> None:
    needs_renderer()
    base, world = look(magni), make_world("")
    assert base.raspicam
    process, state = CameraProcess(world, base, base.raspicam, 1), Simulation(world, base).state()
    try:
        pictures = [process.render(0, state, pixels=True, jpeg=False).pixels for _ in range(3)]
        code = [each for each in psutil.Process(process.pid).memory_maps(grouped=False) if each.perms == "r-xp"]
    finally:
        process.close()
    assert pictures[0] == pictures[2]
    assert sum(each.rss for each in code if "libLLVM" in each.path) < 8e6  # 48 MB while it compiles


def test_camera_says_which_package_is_missing_where_nothing_can_draw(magni: Base, make_world: MakeWorld) -> None:
    base = look(magni)
    assert base.raspicam
    with pytest.raises(UserError, match="cannot draw") as caught:
        CameraProcess(make_world(""), base, base.raspicam, 1, environment={**os.environ, "MUJOCO_GL": "none"})
    assert "libegl1 libopengl0 libgl1-mesa-dri" in str(caught.value.diagnostics[0].help)


def test_camera_ends_cleanly_and_says_so_when_its_process_died(magni: Base, make_world: MakeWorld) -> None:
    needs_renderer()
    base, world = look(magni), make_world("")
    assert base.raspicam
    process = CameraProcess(world, base, base.raspicam, 1)
    drawing = psutil.Process(process.pid)
    drawing.kill()
    with pytest.raises(UserError, match="has ended, expected pictures"):
        process.render(0, Simulation(world, base).state(), pixels=True, jpeg=True)
    process.close()
    assert not drawing.is_running()


def test_end_does_not_wait_for_a_picture_that_is_being_drawn(magni: Base, make_world: MakeWorld) -> None:
    needs_renderer()
    base, world = look(magni), make_world("")
    assert base.raspicam
    process = CameraProcess(world, base, base.raspicam, 1)
    psutil.Process(process.pid).suspend()
    with ThreadPoolExecutor() as drawing:
        picture = drawing.submit(process.render, 0, Simulation(world, base).state(), pixels=True, jpeg=True)
        process.kill()
        with pytest.raises(UserError, match="has ended, expected pictures"):
            picture.result()
    process.close()


def test_pictures_do_not_change_the_motion(magni: Base, make_world: MakeWorld) -> None:
    plain, watched = Simulation(make_world(""), magni), Simulation(make_world(""), magni)
    watched.enable_pictures(30.0)
    due = 0
    for simulation in (plain, watched):
        while simulation.time < 2.0 - 1e-9:
            simulation.command(0, 0.3, 0.2)
            due += "picture" in simulation.advance().due
    assert due == 60
    assert np.array_equal(plain.state(), watched.state())


def test_world_without_fiducials_is_drawn_where_opencv_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cv2", None)  # importing it fails
    assert draw_textures([]) == {}
