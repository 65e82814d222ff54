from pathlib import Path

import numpy as np
import pytest

from ur.robot.base import Base, load_base
from ur_nodes.motion.obstacle_stop.guard import Guard, make_guard
from ur_nodes.motion.obstacle_stop.obstacle_stop import make_sight
from ur_nodes.motion.obstacle_stop.sight import SensorRanges, Sight, look

PACKAGE = Path(__file__).parents[4] / "ubiquity_launches"


def load(name: str) -> Base:
    base, _, variant = name.partition("/")
    return load_base(PACKAGE, base, variant)


def scan_of(distance: float, at: float, toward: float = 0.0) -> SensorRanges:
    """A scan of stage's lidar: a wall across the direction `toward`, so far from the lidar; free elsewhere."""
    angles = -np.pi + np.arange(360) * np.pi / 180.0
    across = np.cos(angles - toward)
    ranges = np.where(across > 0.1, distance / np.maximum(across, 0.1), np.inf)
    return SensorRanges(np.where(ranges > 3.0, np.inf, ranges), (0.12, 12.0), at, -np.pi, np.pi / 180.0)


@pytest.fixture
def sight() -> Sight:
    return make_sight(load("stage"))


def guard_of(sight: Sight, name: str = "stage") -> Guard:
    limits = load(name).limits
    return make_guard(sight, limits, limits.lag)


def seeing(sight: Sight, reading: SensorRanges, number: int = 0) -> Sight:
    return look(sight, sight.sensors[number], reading)
