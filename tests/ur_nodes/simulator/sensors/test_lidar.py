import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from ur.robot.base import Base
from ur.worlds.world_file import WorldModel
from ur_nodes.simulator.simulation import Simulation


def analytic(x: float, y: float, angle: float) -> float:
    """Distance from a point in the room (x from -1 to 5, y from -2 to 2) to its walls."""
    c, s = math.cos(angle), math.sin(angle)
    to_x = ((5.0 if c > 0 else -1.0) - x) / c if abs(c) > 1e-12 else math.inf
    to_y = ((2.0 if s > 0 else -2.0) - y) / s if abs(s) > 1e-12 else math.inf
    return min(to_x, to_y)


def first_scan(world: WorldModel, base: Base, start: tuple[float, float, float], **changes: Any) -> np.ndarray:
    assert base.lidar is not None
    base = dataclasses.replace(base, lidar=dataclasses.replace(base.lidar, **changes))
    simulation = Simulation(world, base, start=start)
    while "scan" not in simulation.advance().due:
        pass
    return simulation.scan(0)


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (3.0, 1.0, 2.0), (1.0, -1.5, -1.0)])
def test_lidar_ranges_are_the_distances_to_the_walls(
    room: WorldModel, stage: Base, start: tuple[float, float, float]
) -> None:
    lidar = stage.lidar
    assert lidar is not None
    ranges = first_scan(room, stage, start, noise=0.0)
    x = start[0] + lidar.pose[0] * math.cos(start[2])
    y = start[1] + lidar.pose[0] * math.sin(start[2])
    angles = np.linspace(lidar.angle_min, lidar.angle_max, lidar.samples) + start[2]
    expected = [analytic(x, y, angle) for angle in angles]
    assert ranges == pytest.approx(np.array(expected), abs=0.002)  # the robot sinks in by a fraction of a mm


def test_lidar_noise_has_the_deviation_of_the_base(room: WorldModel, stage: Base) -> None:
    exact = first_scan(room, stage, (0.0, 0.0, 0.0), noise=0.0)
    noisy = first_scan(room, stage, (0.0, 0.0, 0.0), noise=0.02)
    assert np.std(noisy - exact) == pytest.approx(0.02, rel=0.15)
    assert abs(np.mean(noisy - exact)) < 0.004


def test_lidar_says_infinite_beyond_its_range_and_minus_infinite_below(room: WorldModel, stage: Base) -> None:
    ranges = first_scan(room, stage, (0.0, 0.0, 0.0), noise=0.0, range_min=1.5, range_max=3.0)
    finite = ranges[np.isfinite(ranges)]
    assert ranges[180] == math.inf  # 4.9 m ahead
    assert ranges[0] == -math.inf  # 1.1 m behind
    assert finite.min() >= 1.5
    assert finite.max() <= 3.0
