import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ur.robot.base import Base, ImuErrors
from ur.worlds.world_file import WorldModel
from ur_nodes.simulator.mujoco_model import GRAVITY
from ur_nodes.simulator.physics import BodyMotion
from ur_nodes.simulator.sensors.imu import ImuReading, ImuSense, InertialUnit, specific_force, with_positive_w
from ur_nodes.simulator.simulation import Simulation

PERIOD = 0.02
LEVEL = (0.0,) * 6
Drive = Callable[..., None]
ORIGIN = (0.0, 0.0, 0.0)
number = st.floats(-3.0, 3.0)
vector = st.tuples(number, number, number)


def unit(pose: tuple[float, ...] = LEVEL, gyro: float = 0.0, accel: float = 0.0) -> ImuErrors:
    return ImuErrors("imu", "imu/data", pose, 1.0 / PERIOD, gyro, accel)


def motion(rotation: Rotation) -> BodyMotion:
    """A body that lies still."""
    x, y, z, w = rotation.as_quat().tolist()
    return BodyMotion((x, y, z, w), ORIGIN, ORIGIN)


def read(simulation: Simulation) -> ImuReading:
    """What the unit says when it is next due."""
    while "imu" not in simulation.advance().due:
        pass
    reading = simulation.senses[0].find(ImuSense).read()
    assert reading is not None
    return reading


@given(vector)
def test_unit_at_rest_feels_gravity_upwards_however_it_lies(turn: tuple[float, float, float]) -> None:
    rotation = Rotation.from_rotvec(turn)
    still = motion(rotation)
    force = specific_force(still, still, ORIGIN, PERIOD)
    assert np.allclose(force, rotation.inv().apply([0.0, 0.0, GRAVITY]))


@given(vector, vector)
def test_unit_in_free_fall_feels_nothing(
    turn: tuple[float, float, float], velocity: tuple[float, float, float]
) -> None:
    x, y, z = velocity
    before = replace(motion(Rotation.from_rotvec(turn)), velocity=velocity)
    after = replace(before, velocity=(x, y, z - GRAVITY * PERIOD))
    assert np.allclose(specific_force(before, after, ORIGIN, PERIOD), 0.0, atol=1e-9)


@given(st.floats(0.1, 3.0), st.floats(0.05, 0.5))
def test_unit_off_the_axis_feels_that_it_goes_round(rate: float, radius: float) -> None:
    def at(angle: float) -> BodyMotion:
        return replace(motion(Rotation.from_euler("z", angle)), turning=(0.0, 0.0, rate))

    period = 0.001
    force = specific_force(at(0.3), at(0.3 + rate * period), (radius, 0.0, 0.0), period)
    assert force == pytest.approx([-(rate**2) * radius, 0.0, GRAVITY], abs=1e-4 * (1 + rate**2))


@given(st.floats(-math.pi, math.pi), st.floats(-1.5, 1.5), st.floats(-math.pi, math.pi))
def test_quaternion_is_that_of_the_rotation(roll: float, pitch: float, yaw: float) -> None:
    rotation = Rotation.from_euler("xyz", [roll, pitch, yaw])
    x, y, z, w = with_positive_w(tuple(rotation.as_quat().tolist()))
    assert w >= 0.0
    assert (Rotation.from_quat([x, y, z, w]) * rotation.inv()).magnitude() < 1e-6


def test_unit_that_is_mounted_upside_down_says_so() -> None:
    imu = InertialUnit(unit((0.0, 0.0, 0.1, math.pi, 0.0, 0.0)))
    still = replace(motion(Rotation.identity()), turning=(0.0, 0.0, 0.5))
    imu.sample(still, 0.0)
    reading = imu.read(np.zeros(6))
    assert reading.force == pytest.approx((0.0, 0.0, -GRAVITY))
    assert reading.turning == pytest.approx((0.0, 0.0, -0.5))
    assert [abs(each) for each in reading.orientation] == pytest.approx([1.0, 0.0, 0.0, 0.0])


def test_simulated_unit_integrates_to_the_speed_and_the_heading_of_the_robot(room: WorldModel, stage: Base) -> None:
    simulation = Simulation(room, replace(stage, imu=unit()))
    speed = heading = 0.0
    while simulation.time < 2.0:
        simulation.command(0, 0.4, 0.5)
        if "imu" in simulation.advance().due:
            reading = simulation.senses[0].find(ImuSense).read()
            assert reading is not None
            heading += reading.turning[2] * PERIOD
            speed += reading.force[0] * PERIOD
    assert heading == pytest.approx(simulation.pose(0)[2], abs=0.02)
    assert speed == pytest.approx(simulation.velocity(0)[0], abs=0.03)
    assert math.hypot(*read(simulation).orientation[2:]) == pytest.approx(1.0, abs=1e-3)


def test_simulated_unit_feels_a_turn_sideways_and_gravity(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, replace(stage, imu=unit()))
    drive(simulation, 2.0, 0.4, 0.5)
    readings = []
    for _ in range(50):
        simulation.command(0, 0.4, 0.5)
        readings.append(read(simulation))
    assert np.mean([each.force[1] for each in readings]) == pytest.approx(0.4 * 0.5, abs=0.03)
    assert np.mean([each.force[2] for each in readings]) == pytest.approx(GRAVITY, abs=0.05)
    assert np.mean([each.turning[2] for each in readings]) == pytest.approx(0.5, abs=0.02)


def test_simulated_unit_feels_the_bump_into_a_wall(room: WorldModel, stage: Base) -> None:
    simulation = Simulation(room, replace(stage, imu=unit()), start=(4.4, 0.0, 0.0))
    hardest = 0.0
    while simulation.time < 3.0:
        simulation.command(0, 0.5, 0.0)
        hardest = min(hardest, read(simulation).force[0])
    assert hardest < -3.0


def test_simulated_unit_does_not_feel_that_it_is_placed_elsewhere(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, replace(stage, imu=unit()))
    drive(simulation, 1.0, 0.5)
    simulation.set_pose("robot", (3.0, 1.0, 1.0))
    force = read(simulation).force
    assert max(abs(force[0]), abs(force[1]), abs(force[2] - GRAVITY)) < 0.6


def test_noise_has_the_deviation_of_the_base_and_repeats_itself_after_a_reset(room: WorldModel, stage: Base) -> None:
    simulation = Simulation(room, replace(stage, imu=unit(gyro=0.01, accel=0.1)), seed=7)
    first = [read(simulation) for _ in range(400)]
    assert np.std([each.turning[0] for each in first[20:]]) == pytest.approx(0.01, rel=0.15)
    assert np.std([each.force[0] for each in first[20:]]) == pytest.approx(0.1, rel=0.15)
    simulation.reset()
    assert [read(simulation) for _ in range(400)] == first
