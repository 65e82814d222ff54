"""Many robots in the simulator: processor time for a simulated second, alone, with every scan, and as a node."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from bench.scale_parts.rows import Row

SIZES = (1, 5, 10, 25, 50)
SIZE = "robots"
PEER = ""
_ROOT = Path(__file__).resolve().parents[2]
_SECONDS = 5.0  # simulated
_SPEED = (0.1, 0.5)  # m/s, rad/s: circles side by side
_RESOLUTION = 0.1  # m
_ROOM, _LENGTH, _WIDTH = 1.0, 2.0, 8.0  # m: length for each robot, beside that for all, and width of the hall
_LINE = re.compile(r" *(\d+) robots? +at full speed: real-time factor ([\d.]+) .* CPU (\d+) % of a core")


def measure(sizes: Sequence[int]) -> Iterator[Row]:
    """Rows for robots that drive in a hall with pillars, which has the same size for all of `sizes`.

    Costs are ms of processor time for a simulated second. The node's robots stand; scans, odometry and tf are received.
    """
    with tempfile.TemporaryDirectory() as folder:
        world = make_hall(Path(folder), _LENGTH + _ROOM * max(sizes))
        for size in sizes:
            yield Row("simulator: physics, odometry", size, measure_simulation(world, size, scans=False), "ms/s")
            yield Row("simulator: and scans", size, measure_simulation(world, size, scans=True), "ms/s")
        yield from _measure_node(world, sizes)


def make_hall(folder: Path, length: float) -> Path:
    """Write a world: a hall of a length (m) with two rows of pillars. Returns its file."""
    cells = np.full((round(_WIDTH / _RESOLUTION), round(length / _RESOLUTION)), 254, np.uint8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 0
    for row in (20, -22):
        for column in range(20, cells.shape[1], 40):
            cells[row : row + 2, column : column + 2] = 0
    header = f"P5 {cells.shape[1]} {cells.shape[0]} 255\n".encode()
    (folder / "hall.pgm").write_bytes(header + cells.tobytes())
    world = folder / "hall.yaml"
    world.write_text(
        f"image: hall.pgm\nresolution: {_RESOLUTION}\norigin: [-1.0, {-_WIDTH / 2.0}, 0.0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return world


def measure_simulation(world: Path, robots: int, *, scans: bool) -> float:
    """The processor time (ms) for a simulated second of robots that drive, without ROS."""
    from ur.robot.base import load_base
    from ur.source.project import launch_library
    from ur.worlds.world_file import read_world
    from ur_nodes.simulator.simulation import Simulation

    simulation = Simulation(read_world(world), load_base(launch_library(), "stage", ""), robots=robots)
    began = time.process_time()
    while simulation.time < _SECONDS:
        for robot in range(robots):
            simulation.command(robot, *_SPEED)
        if simulation.advance().scan and scans:
            for robot in range(robots):
                simulation.scan(robot)
    if any(simulation.collisions):
        raise RuntimeError(f"robots collided: {simulation.collisions}, expected them to drive side by side")
    return 1000.0 * (time.process_time() - began) / simulation.time


def _measure_node(world: Path, sizes: Sequence[int]) -> Iterator[Row]:
    command = [sys.executable, str(_ROOT / "bench" / "simulator"), "--runs", "1", "--seconds", "3"]
    command += ["--world", str(world), "--robots", ",".join(map(str, sizes))]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if match := _LINE.match(line):
                robots, factor, load = (float(word) for word in match.groups())
                yield Row("simulator: node, with subscribers", robots, 10.0 * load / factor, "ms/s")
    if process.returncode:
        raise RuntimeError(f"bench/simulator ended with {process.returncode}")
