"""What holds for every base and variant of the library: it stands on its wheels, and drives and stops as it says."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ur.robot.base import Base, list_bases, list_variants, load_base
from ur.worlds.world_file import WorldModel
from ur_nodes.simulator.simulation import Simulation

PACKAGE = Path(__file__).resolve().parents[3] / "ubiquity_launches"
EVERY = [(name, variant) for name in list_bases(PACKAGE) for variant in ("", *list_variants(PACKAGE, name))]
Drive = Callable[..., None]


@pytest.fixture(params=EVERY, ids=lambda pair: ".".join(filter(None, pair)))
def base(request: pytest.FixtureRequest) -> Base:
    return load_base(PACKAGE, *request.param)


def tilt(simulation: Simulation) -> float:
    """How far the robot leans, rad. Its free joint is the first in the state: x, y, z and a quaternion."""
    _, x, y, _ = simulation.state()[3:7]
    return float(np.arccos(1.0 - 2.0 * (x * x + y * y)))


def test_base_drives_straight_at_full_speed_and_stands_upright(room: WorldModel, base: Base, drive: Drive) -> None:
    simulation = Simulation(room, base)
    limits = base.limits
    start_up = limits.velocity / limits.acceleration
    seconds = start_up + 2.0
    drive(simulation, seconds, linear=2.0 * limits.velocity)
    x, y, yaw = simulation.pose(0)
    assert x == pytest.approx(limits.velocity * (2.0 + start_up / 2.0), rel=0.05)
    assert (y, yaw) == pytest.approx((0.0, 0.0), abs=0.01)
    assert tilt(simulation) < 0.02


def test_base_turns_at_full_rate_on_the_spot(room: WorldModel, base: Base, drive: Drive) -> None:
    simulation = Simulation(room, base)
    limits = base.limits
    seconds = limits.angular_velocity / limits.angular_acceleration + 1.0
    drive(simulation, seconds, angular=limits.angular_velocity)
    x, y, yaw = simulation.pose(0)
    assert yaw == pytest.approx(limits.angular_velocity * (seconds - (seconds - 1.0) / 2.0), rel=0.06)
    assert math.hypot(x, y) < 0.02
    assert tilt(simulation) < 0.02


def test_base_brakes_from_full_speed_within_its_deceleration_without_tipping(
    room: WorldModel, base: Base, drive: Drive
) -> None:
    simulation = Simulation(room, base)
    limits = base.limits
    drive(simulation, 2.0, linear=limits.velocity)
    drive(simulation, limits.velocity / limits.deceleration + 0.1)
    assert simulation.velocity(0)[0] == pytest.approx(0.0, abs=0.02)
    assert tilt(simulation) < 0.02
