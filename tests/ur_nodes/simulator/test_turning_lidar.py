"""Lidars whose heads turn while they measure, as those of real robots do."""

import dataclasses
import math
from collections.abc import Iterator
from importlib import import_module

import numpy as np
import pytest
from tests.ur_nodes.first_drive.stage import DrivenStage
from tests.ur_nodes.simulator.conftest import PACKAGE

from ur.robot.base import Base, load_base
from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.worlds.world_file import WorldModel
from ur_nodes.ports.values import Scan
from ur_nodes.simulator.simulation import Simulation
from ur_nodes.simulator.turning_lidar import TurningLidar, direction_of

ROBOTS = [("create2", "lidar", -1), ("botvac", "", 1)]


def load(name: str, variant: str) -> Base:
    base = load_base(PACKAGE, name, variant)
    assert base.lidar
    return dataclasses.replace(base, lidar=dataclasses.replace(base.lidar, noise=0.0))


def turns_of(simulation: Simulation, head: TurningLidar, turn: float) -> Iterator[np.ndarray]:
    """The scans of a robot that turns on the spot, rad/s, or rests."""
    while True:
        simulation.command(0, 0.0, turn)
        ranges = head.measure(due="scan" in simulation.advance().due)
        if ranges is not None:
            yield ranges


@pytest.mark.parametrize(("name", "variant", "direction"), ROBOTS)
def test_lidar_of_a_robot_at_rest_sees_what_one_does_that_measures_at_once(
    room: WorldModel, name: str, variant: str, direction: int
) -> None:
    simulation = Simulation(room, load(name, variant))
    head = TurningLidar(simulation)
    ranges = next(turns_of(simulation, head, 0.0))
    assert ranges == pytest.approx(simulation.scan(0), abs=0.001)
    assert math.copysign(1.0, head.increment) == direction == direction_of(simulation.base)


@pytest.mark.parametrize("turn", [0.8, -0.8])
@pytest.mark.parametrize(("name", "variant"), [robot[:2] for robot in ROBOTS])
def test_each_beam_of_a_robot_that_turns_is_measured_from_where_the_robot_was_by_then(
    room: WorldModel, name: str, variant: str, turn: float
) -> None:
    simulation = Simulation(room, load(name, variant))
    lidar = simulation.base.lidar
    assert lidar
    head = TurningLidar(simulation)
    scans = turns_of(simulation, head, turn)
    for _ in range(6):
        ranges = next(scans)
    begun = head.first + min(0.0, head.increment * (lidar.samples - 1))
    assert begun == pytest.approx(simulation.time - 1.0 / lidar.rate, abs=0.01)
    rate = simulation.velocity(0)[2]
    assert rate == pytest.approx(turn, rel=0.05)
    pose, at = simulation.pose(0), head.first + head.increment * np.arange(lidar.samples)
    heading = pose.yaw + rate * (at - simulation.time)
    angles = np.linspace(lidar.angle_min, lidar.angle_max, lidar.samples) + heading
    hits = np.isfinite(ranges)
    x = pose.x + lidar.pose[0] * np.cos(heading) + np.where(hits, ranges, 0.0) * np.cos(angles)
    y = pose.y + lidar.pose[0] * np.sin(heading) + np.where(hits, ranges, 0.0) * np.sin(angles)
    off = np.min(np.abs((x + 1.0, x - 5.0, y + 2.0, y - 2.0)), axis=0)[hits]
    assert np.quantile(off, 0.99) < 0.02


def test_scan_of_a_simulated_robot_is_stamped_as_its_driver_does() -> None:
    stage = DrivenStage("maze", base="create2", variant="lidar")
    scans = stage.record("scan", Scan)
    stage.bus.run(1.0)
    scan = scans[-1]
    turn = scan.time_increment * (len(scan.ranges) - 1)
    assert turn == pytest.approx(-1.0 / 5.5, rel=0.05)  # clockwise: the first beam of the array is measured last
    assert 0 <= stage.bus.now - scan.stamp < 0.25e9
    assert len({scan.stamp for scan in scans}) == len(scans)


def test_lidar_that_only_a_simulated_robot_has_measures_at_once() -> None:
    stage = DrivenStage("maze")
    scans = stage.record("scan", Scan)
    stage.bus.run(0.5)
    assert {scan.time_increment for scan in scans} == {0.0}


def test_lidars_turn_as_the_stand_ins_of_their_drivers_do() -> None:
    clockwise = set()
    for name, own in OWN_DRIVERS.items():
        module, _, protocol = own.entry_point.partition(":")
        if own.sensor == "lidar":
            firmware = getattr(import_module(f"ur_nodes.drivers.{module}"), f"{protocol}Firmware")
            clockwise |= {name} if firmware.clockwise else set()
    assert clockwise == {name for name, driver in OWN_DRIVERS.items() if driver.clockwise}
