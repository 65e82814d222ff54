"""A Neato's whole line: base, lidar, bumpers, cliff sensors and battery on one device."""

import numpy as np
import pytest
from tests.ur_nodes.drivers.rig import DriverRig
from tests.ur_nodes.drivers.test_base_driver import REST, drive_off, lines, rest_after

from ur_nodes.ports.node import SECOND
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery, Scan


def make_rig() -> DriverRig:
    return DriverRig("botvac")


def test_one_line_brings_scans_bumpers_cliffs_and_the_battery() -> None:
    rig = make_rig()
    scans, states = rig.record("scan", Scan), rig.record("battery_state", Battery)
    bumper = rig.record("bumper/left_front", bool, Quality.LATCHED)
    cliff = rig.record("cliff/right", bool, Quality.LATCHED)
    rig.drive(0.0, 0.0, 3.0)
    assert (bumper, cliff) == ([False], [False])
    assert states[-1].voltage == pytest.approx(13.5, abs=0.01)
    assert states[-1].fraction == pytest.approx(1.0, abs=0.02)
    ranges = rig.simulation.scan(0)
    seen = np.isfinite(scans[-1].ranges) & np.isfinite(ranges)
    assert seen.mean() > 0.5
    assert np.median(np.abs(scans[-1].ranges[seen] - ranges[seen])) < 0.03
    assert (scans[-1].stamp - scans[-6].stamp) / SECOND == pytest.approx(1.0, abs=0.1)
    assert rig.bus.now - scans[-1].stamp < 0.5 * SECOND
    rig.bench.plant.bumpers = lambda: {"left_front": True}  # type: ignore[method-assign]
    rig.bench.plant.cliffs = lambda: {"right": True}  # type: ignore[method-assign]
    rig.drive(0.0, 0.0, 0.5)
    assert (bumper, cliff) == ([False, True], [False, True])


def test_lifted_neato_rests_and_drives_again_on_the_floor() -> None:
    rig = make_rig()
    drive_off(rig)
    rig.firmware.lifted = True
    rig.drive(0.3, 0.0, 1.0)
    assert rest_after(rig, 0.01) < REST
    assert any("a wheel hangs in the air" in line for line in lines(rig))
    rig.firmware.lifted = False
    rig.drive(0.0, 0.0, 1.0)
    drive_off(rig)


def test_neato_is_left_as_it_was_found_with_its_lidar_at_rest() -> None:
    rig = make_rig()
    drive_off(rig)
    assert rig.firmware.test_mode
    rig.bus.nodes["/base_driver"].end("the test ends it")
    rig.bus.run(0.1)
    assert not rig.firmware.test_mode
    assert not rig.firmware._head.turns


def test_base_whose_lidar_has_a_driver_of_its_own_gets_no_second_scan() -> None:
    rig = DriverRig("botvac")
    assert "scan" not in {each for each in rig.firmware.covers if each != "lidar"}
    assert rig.driver._topics._scans is not None
    magni = DriverRig("magni", variant="lidar")
    assert magni.driver._topics._scans is None
