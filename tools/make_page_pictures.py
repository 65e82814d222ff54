"""Make the pictures of the pages on navigating, simulating and two computers, in docs/images.

Usage: tools/make_page_pictures.py [NAME ...]. The names: navigate (RViz while a simulated robot drives to a goal; needs
Xvfb and RViz), simulate (the simulated camera's picture; needs OpenGL and OpenCV), two_computers (`ur robots`).
"""

import io
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image, ImageGrab
from rich.console import Console
from rich.text import Text

from ur.cli.robots.robots import _picture
from ur.robot.base import load_base
from ur.robot.discovery.listing import RobotAnswer, RobotRow
from ur.robot.discovery.seen import SeenRobot
from ur.worlds.world_file import read_world
from ur_nodes.simulator.camera.camera_process import CameraProcess
from ur_nodes.simulator.simulation import Simulation

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tests.ros_session import free_port
from tools.pictures import ROOT, clean_svg, end, make_named, start_screen, wait_until

LIBRARY = ROOT / "ubiquity_launches"
PLAN_COLOUR = (78, 154, 6)  # of the global plan in rviz_navigation


def make_navigate() -> Image.Image:
    """Take the window of RViz once the global plan is drawn."""
    for program in ("Xvfb", "rviz"):
        if not shutil.which(program):
            raise SystemExit(f"error: {program} is not installed; apt-get install xvfb rviz")
    with tempfile.TemporaryDirectory() as home, start_screen(Path(home), 1200, 720) as environment:
        run = subprocess.Popen(
            [ROOT / "ur", "run", "keyboard_navigate", "robot_base:=magni", "robot_variant:=lidar"],
            env={**environment, "ROS_MASTER_URI": f"http://localhost:{free_port()}"},
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
        )
        assert run.stdin
        try:
            run.stdin.write(b"g 12.1 7.65 90\n")
            run.stdin.flush()
            pictures: list[Image.Image] = []

            def is_planned() -> bool:
                pictures[:] = [ImageGrab.grab(xdisplay=environment["DISPLAY"]).convert("RGB")]
                near = (np.abs(np.asarray(pictures[0]).astype(int) - PLAN_COLOUR) < 24).all(axis=2)
                return bool(near.sum() > 200)

            wait_until(is_planned, "a plan in RViz")
            return pictures[0]
        finally:
            end(run)


def make_simulate() -> Image.Image:
    """Draw what the camera of the base `stage` sees in the office."""
    world, base = read_world(LIBRARY / "n_simulator" / "worlds" / "office.yaml"), load_base(LIBRARY, "stage")
    assert base.raspicam
    simulation = Simulation(world, base)
    process = CameraProcess(world, base, base.raspicam, 1)
    try:
        jpeg = process.render(0, simulation.state(), pixels=False, jpeg=True).jpeg
    finally:
        process.close()
    return Image.open(io.BytesIO(jpeg))


def make_two_computers() -> str:
    """Render the table of `ur robots` with two robots that are there and one that is away."""
    now = time.time()
    services = (("magni-base", "active"),)
    rows = [
        RobotRow(
            "bob", "192.168.1.23", "magni", "lidar", "0.1.0", RobotAnswer(nodes=7, services=services, offset=0.003)
        ),
        RobotRow("eve", "192.168.1.31", "loki", "", "0.1.0", RobotAnswer(nodes=0, services=(), offset=-0.011)),
        RobotRow("joe", "", seen=SeenRobot("joe", "192.168.1.40", now - 7300.0)),
    ]
    console = Console(record=True, width=116, file=io.StringIO())
    console.print(Text("$ ur robots"))
    console.print(_picture(rows))
    console.print(Text("$ ur use bob\nbob\n$ ur run keyboard_navigate"))
    return clean_svg(console.export_svg(title="laptop", unique_id="terminal"))


PICTURES: dict[str, Callable[[], Image.Image | str]] = {
    "navigate": make_navigate,
    "simulate": make_simulate,
    "two_computers": make_two_computers,
}

if __name__ == "__main__":
    sys.exit(make_named(PICTURES, sys.argv[1:]))
