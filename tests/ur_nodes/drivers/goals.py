"""Goals through a driver and its stand-ins, and without: python -m tests.ur_nodes.drivers.goals [COUNT [BOARD]].

The whole first drive in the maze, on a bus in memory, where load changes nothing: goals reached of ten for each of
COUNT seeds, the sum of the times, and the distance of the true pose from the goal. `plain` is the same base whose
simulator publishes the topics itself.
"""

from __future__ import annotations

import importlib
import math
import statistics
import sys
from collections.abc import Callable
from dataclasses import replace

from tests.base_contract import PACKAGE, load
from tests.ur_nodes.drivers.rig import DriverRig
from tests.ur_nodes.first_drive.drive import FirstDrive

from ur.robot.base import Base
from ur.robot.base.own_drivers import OWN_DRIVERS
from ur_nodes.ports.node import SECOND

BASES = {
    "arduino": ("create2", "lidar"),
    "create2": ("create2", "lidar"),
    "loki": ("create2", "lidar"),
    "magni": ("magni", "lidar"),
    "neato": ("botvac", ""),
    "turtlebot3": ("create2", "lidar"),
}
LONGEST = 300.0  # s for a goal


class DeviceDrive(FirstDrive, DriverRig):
    """The first drive, through drivers."""


def with_drivers(board: str) -> Callable[[Base], Base]:
    """Change a base: a board and an RPLIDAR, by drivers of ours. A Neato has a lidar of its own."""
    own = load("create2", "lidar")
    driver, lidars = own.driver, own.drivers if BASES[board][1] else ()
    assert driver

    def change(base: Base) -> Base:
        return replace(base, driver=replace(driver, protocol=board, device=OWN_DRIVERS[board].device), drivers=lidars)

    return change


def drive(stage: FirstDrive) -> tuple[int, float, list[float]]:
    """Drive to the goals; return how many were reached, the sum of the times (s), and the final errors (m)."""
    sys.path.insert(0, str(PACKAGE.parent / "bench"))
    goals = importlib.import_module("navigation_parts.worlds").GOALS["maze"]

    reached, seconds, errors = 0, 0.0, []
    for x, y, degrees in goals:
        begun = stage.bus.now
        end = stage.go(x, y, math.radians(degrees), LONGEST)
        reached += end.state == "succeeded"
        seconds += (stage.bus.now - begun) / SECOND
        errors.append(math.dist(stage.truth.pose[:2], (x, y)))
    return reached, seconds, errors


def try_seeds(board: str, name: str, seeds: range) -> tuple[float, float]:
    """Drive with each seed, and print what came of it; return the sum of the times (s) and the mean error (m)."""
    base, variant = BASES[board]
    times, errors = list[float](), list[float]()
    for seed in seeds:
        stage = (
            DeviceDrive(base=base, variant=variant, change=with_drivers(board), seed=seed)
            if name == "devices"
            else FirstDrive(base=base, variant=variant, seed=seed)
        )
        reached, seconds, found = drive(stage)
        times.append(seconds)
        errors += found
        text = (
            f"{reached} of {len(found)} goals, {seconds:.1f} s, error {statistics.mean(found):.4f}, {max(found):.4f} m"
        )
        sys.stdout.write(f"{board} {name} {seed}: {text}\n")
        sys.stdout.flush()
    return sum(times), statistics.mean(errors)


def main() -> None:
    """Drive with and without drivers, and compare."""
    seeds = range(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
    for board in sys.argv[2:] or list(BASES):
        (plain, error), (seconds, own) = (try_seeds(board, name, seeds) for name in ("plain", "devices"))
        sys.stdout.write(f"{board}: time {seconds / plain:.3f}, error {own / error:.3f} of the plain simulator\n")


if __name__ == "__main__":
    main()
