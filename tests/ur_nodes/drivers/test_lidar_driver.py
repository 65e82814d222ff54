"""Drivers of lidars behind stand-ins: their scans are what the stand-ins measured, when they measured it."""

import random
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.base_contract import load
from tests.ur_nodes.drivers.rig import Cable, DriverRig, one_of
from tests.ur_nodes.drivers.scans import ANGLE, TIME, compare

from ur.robot.base import Base
from ur.robot.base.own_drivers import OWN_DRIVERS
from ur_nodes.drivers.registry import LIDARS
from ur_nodes.ports.node import SECOND
from ur_nodes.ports.values import Scan

NAMES = sorted(LIDARS)
ONE = one_of(LIDARS, "rplidar")
TURN = 1.0 / 5.5  # s
CORRECTED = ("lds02", "ydlidar")


def with_lidar(name: str) -> Any:
    """Change a base: its lidar has another driver of ours, and no noise."""
    driver = load("create2", "lidar").drivers[0]

    def change(base: Base) -> Base:
        assert base.lidar
        own = replace(driver, protocol=name, device=OWN_DRIVERS[name].device)
        return replace(base, lidar=replace(base.lidar, noise=0.0), drivers=(own,))

    return change


def make_rig(name: str) -> DriverRig:
    return DriverRig("create2", variant="lidar", change=with_lidar(name))


def lidar_cable(rig: DriverRig) -> Cable:
    return next(cable for path, cable in rig.cables.items() if path != "/dev/create")


def lines(rig: DriverRig) -> list[str]:
    return [text for _, text in rig.bus.nodes["/lidar_driver"].lines]


@pytest.mark.parametrize("name", NAMES)
def test_scans_are_what_the_lidar_measured_at_the_angles_at_which_it_did(name: str) -> None:
    rig = make_rig(name)
    scans = rig.record("scan", Scan)
    rig.bus.run(2.0)
    assert len(scans) in (8, 9, 10)  # a Hokuyo sends whole turns, and begins after its second answer
    exact = rig.simulation.scan(0)
    turn = scans[-1]
    there = ~np.isnan(turn.ranges)
    # The corrections of some put two beams into one step of the scan, and none into others.
    assert np.count_nonzero(there) > (300 if name in CORRECTED else 355)
    error = np.abs(turn.ranges - exact)[there & np.isfinite(exact)]
    assert np.quantile(error, 0.9) < (0.06 if name in CORRECTED else 0.002)


@pytest.mark.parametrize("name", ONE)
def test_stamp_is_the_time_of_the_first_beam_and_increments_reach_the_last(name: str) -> None:
    rig = make_rig(name)
    scans = rig.record("scan", Scan)
    rig.bus.run(3.0)
    steps = np.diff([each.stamp for each in scans]) / SECOND
    assert np.abs(steps - TURN).max() < 0.03
    for scan in scans:
        assert scan.scan_time == pytest.approx(TURN, abs=0.03)
        assert abs(scan.time_increment) * 360 == pytest.approx(scan.scan_time, rel=0.01)
        assert (scan.time_increment > 0.0) is (name in ("hokuyo", "xv11"))


@pytest.mark.parametrize("name", NAMES)
def test_each_beam_has_the_angle_and_the_time_at_which_it_was_measured(name: str) -> None:
    scans, beams, angle, late = compare(name, 0.1)
    assert scans > 25
    assert beams > 300 * scans
    assert (angle < ANGLE, late < TIME) == (True, True), (angle, late)


@pytest.mark.parametrize("name", ONE)
def test_unplugged_lidar_is_named_and_scans_again_when_it_is_back(name: str) -> None:
    rig = make_rig(name)
    scans = rig.record("scan", Scan)
    rig.bus.run(1.0)
    cable = lidar_cable(rig)
    cable.plugged = False
    rig.bus.run(1.0)
    count = len(scans)
    assert any("unplugged" in line and LIDARS[name]().name in line for line in lines(rig))
    cable.plugged = True
    rig.bus.run(1.5)
    assert len(scans) >= count + 5
    assert max(each.scan_time for each in scans) < 0.25


@pytest.mark.parametrize("name", ONE)
def test_noise_damages_single_beams_at_most(name: str) -> None:
    rig = make_rig(name)
    scans = rig.record("scan", Scan)
    rig.bus.run(0.5)
    cable = lidar_cable(rig)
    cable.random, cable.noise, cable.cut = random.Random(3), 0.001, 0.02
    rig.bus.run(3.0)
    exact = rig.simulation.scan(0)
    assert len(scans) > 10
    for scan in scans:
        error = np.abs(scan.ranges - exact)[np.isfinite(scan.ranges) & np.isfinite(exact)]
        assert np.count_nonzero(error > 0.15) < (40 if name in CORRECTED else 12)


@pytest.mark.parametrize("name", ONE)
def test_lidar_that_does_not_turn_is_reported_with_what_to_do(name: str) -> None:
    rig = make_rig(name)
    firmware = next(each for path, each in rig.bench.firmwares.items() if path != "/dev/create")
    firmware.turns = False  # type: ignore[attr-defined]
    rig.bus.run(4.0)
    assert any("no beams of" in line and "ur devices" in line for line in lines(rig))
    firmware.turns = True  # type: ignore[attr-defined]
    scans = rig.record("scan", Scan)
    rig.bus.run(2.0)
    assert scans


def test_broken_rplidar_says_so_and_is_named() -> None:
    rig = make_rig("rplidar")
    firmware: Any = next(each for path, each in rig.bench.firmwares.items() if path != "/dev/create")
    answer = firmware._answer
    firmware._answer = lambda command: bytes.fromhex("a55a0300000006020180") if command == 0x52 else answer(command)
    lidar_cable(rig).plugged = False
    rig.bus.run(0.5)
    lidar_cable(rig).plugged = True
    rig.bus.run(1.0)
    assert any("it reports that it is broken (error 0x8001)" in line for line in lines(rig))
    assert any("model 1.8, firmware 1.29" in line for line in lines(rig))


def test_lidar_is_stopped_when_its_node_ends() -> None:
    rig = make_rig("rplidar")
    rig.bus.run(1.0)
    rig.bus.nodes["/lidar_driver"].end("the test ends it")
    assert lidar_cable(rig).sent.endswith(b"\xa5\x25\xa5\xf0\x02\x00\x00\x57")
