"""Bases that are read from descriptions: they stand on their wheels, and drive and stop as their base files say."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.robot.description.urdfs import FOUR_WHEELS, MESHES, SMALL

from ur.robot.base import Base, read_base
from ur.robot.description.base_text import write_base_file
from ur.robot.description.parse import parse_urdf
from ur.robot.description.reading import read_base_figures
from ur.worlds.world_file import WorldModel
from ur_nodes.simulator.simulation import Simulation

SPEEDS = {"small": (0.22, 1.5), "four": (0.6, 1.2), "meshes": (0.4, 1.5)}
TEXTS = {"small": SMALL, "four": FOUR_WHEELS, "meshes": MESHES}
Drive = Callable[..., None]


@pytest.fixture(params=sorted(TEXTS))
def base(request: pytest.FixtureRequest, tmp_path: Path) -> Base:
    velocity, angular_velocity = SPEEDS[request.param]
    description = parse_urdf(TEXTS[request.param], request.param)
    reading = read_base_figures(description, {"velocity": velocity, "angular_velocity": angular_velocity})
    path = tmp_path / "base.yaml"
    path.write_text(write_base_file(reading, "A robot.", "robot.urdf"), encoding="utf-8")
    return read_base(path, request.param)


def test_described_base_drives_turns_and_brakes_without_tipping(room: WorldModel, base: Base, drive: Drive) -> None:
    simulation, limits = Simulation(room, base), base.limits
    seconds = limits.velocity / limits.acceleration + 2.0
    drive(simulation, seconds, linear=limits.velocity)
    ahead, aside, yaw = simulation.pose(0)
    assert ahead == pytest.approx(limits.velocity * (seconds - limits.velocity / limits.acceleration / 2.0), rel=0.05)
    assert (aside, yaw) == pytest.approx((0.0, 0.0), abs=0.01)
    drive(simulation, limits.velocity / limits.deceleration + 0.1)
    assert simulation.velocity(0)[0] == pytest.approx(0.0, abs=0.02)
    drive(simulation, limits.angular_velocity / limits.angular_acceleration + 0.5, angular=limits.angular_velocity)
    assert simulation.velocity(0)[-1] == pytest.approx(limits.angular_velocity, rel=0.06)
    _, x, y, _ = simulation.state()[3:7]
    assert np.hypot(x, y) < 0.01, "it leans"
