"""Make the pictures of the pages on navigating, simulating and two computers, in docs/images.

Usage: tools/make_page_pictures.py [NAME ...]. The names: navigate (RViz while a simulated robot drives to a goal; needs
Xvfb and RViz), simulate (the simulated camera's picture; needs OpenGL and OpenCV), two_computers (`ur robots`).
"""

from __future__ import annotations

import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
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

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
LIBRARY = ROOT / "ubiquity_launches"
LIMIT = 180.0  # s; a busy computer draws slowly
PLAN_COLOUR = (78, 154, 6)  # of the global plan in rviz_navigation
PORT = 11399


def make_navigate() -> Path:
    """Take the window of RViz once the global plan is drawn."""
    for program in ("Xvfb", "rviz"):
        if not shutil.which(program):
            raise SystemExit(f"error: {program} is not installed; apt-get install xvfb rviz")
    path = IMAGES / "navigate.png"
    reader, writer = os.pipe()
    screen = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writer), "-screen", "0", "1200x720x24", "-nolisten", "tcp", "-noreset"],
        pass_fds=[writer],
        stderr=subprocess.DEVNULL,
    )
    os.close(writer)
    with os.fdopen(reader) as answer, tempfile.TemporaryDirectory() as home:
        display = f":{answer.readline().strip()}"
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("ROS", "WAYLAND"))}
        own = {"DISPLAY": display, "HOME": home, "XDG_RUNTIME_DIR": home, "LIBGL_ALWAYS_SOFTWARE": "1"}
        run = subprocess.Popen(
            [ROOT / "ur", "run", "keyboard_navigate", "robot_base:=magni", "robot_variant:=lidar"],
            env={**kept, **own, "ROS_MASTER_URI": f"http://localhost:{PORT}"},
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
        )
        assert run.stdin
        try:
            run.stdin.write(b"g 12.1 7.65 90\n")
            run.stdin.flush()
            picture = _await_plan(display)
        finally:
            run.terminate()
            run.wait()
            screen.terminate()
            screen.wait()
    picture.quantize(64, dither=Image.Dither.NONE).save(path, optimize=True)
    return path


def _await_plan(display: str) -> Image.Image:
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        picture = ImageGrab.grab(xdisplay=display).convert("RGB")
        near = (np.abs(np.asarray(picture).astype(int) - PLAN_COLOUR) < 24).all(axis=2)
        if near.sum() > 200:
            return picture
        time.sleep(0.5)
    raise SystemExit(f"error: RViz shows no plan within {LIMIT:.0f} s")


def make_simulate() -> Path:
    """Draw what the camera of the base `stage` sees in the office."""
    path = IMAGES / "simulate.png"
    world, base = read_world(LIBRARY / "n_simulator" / "worlds" / "office.yaml"), load_base(LIBRARY, "stage")
    assert base.raspicam
    simulation = Simulation(world, base)
    process = CameraProcess(world, base, base.raspicam, 1)
    try:
        jpeg = process.render(0, simulation.state(), pixels=False, jpeg=True).jpeg
    finally:
        process.close()
    Image.open(io.BytesIO(jpeg)).quantize(64).save(path, optimize=True)
    return path


def make_two_computers() -> Path:
    """Render the table of `ur robots` with two robots that are there and one that is away."""
    path = IMAGES / "two_computers.svg"
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
    svg = console.export_svg(title="laptop", unique_id="terminal")
    path.write_text(re.sub(r"@font-face \{.*?\}\s*", "", svg, flags=re.DOTALL), encoding="utf-8")
    return path


PICTURES = {"navigate": make_navigate, "simulate": make_simulate, "two_computers": make_two_computers}


def main(names: list[str]) -> int:
    """Make the pictures with these names, all without any. Returns the exit code."""
    unknown = [name for name in names if name not in PICTURES]
    if unknown:
        print(f"error: {unknown[0]!r} is not known, expected one of {', '.join(PICTURES)}", file=sys.stderr)
        return 2
    for name in names or PICTURES:
        path = PICTURES[name]()
        print(f"{path}: {path.stat().st_size // 1024} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
