"""The driver of u-blox receivers: places, what it asks for, and the faults of lines and receivers."""

from __future__ import annotations

import math
import random

import pytest
from tests.ur_nodes.drivers.gnss.receiver import Receiver
from tests.ur_nodes.drivers.rig import Cable, MemoryLine

from ur.devices.driver_health import DriverHealth
from ur_nodes.drivers.gnss import gnss_driver_node
from ur_nodes.drivers.gnss.gnss_driver import GnssDriver
from ur_nodes.drivers.gnss.ublox import Ublox
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.values import GeoFix

PERIOD = 0.2  # s


class DrivenReceiver:
    """A driver on a bus, and its receiver behind a cable."""

    def __init__(self) -> None:
        self.bus, self.cable, self.receiver = Bus(), Cable(), Receiver()
        self.fixes: list[GeoFix] = []
        self.health: list[DriverHealth] = []
        world = self.bus.node("world")
        world.subscribe("fix", GeoFix, self.fixes.append)
        world.every(PERIOD, lambda: self.cable.write(self.receiver.take(self.cable.read()) + self.receiver.tick()))
        self.node = self.bus.node("gnss_driver")
        GnssDriver(
            self.node,
            "gps",
            Ublox(),
            lambda user, settings: MemoryLine(self.node, self.cable, user, settings),
            self.health.append,
        )

    @property
    def lines(self) -> list[str]:
        return [text for _, text in self.node.lines]


def test_places_are_those_of_the_receiver_in_degrees_and_metres_above_the_ellipsoid() -> None:
    driven = DrivenReceiver()
    driven.receiver.corrected = True
    driven.bus.run(3.0)
    fix = driven.fixes[-1]
    assert len(driven.fixes) >= 12
    assert (fix.latitude, fix.longitude) == pytest.approx((48.1373932, -11.5754485), abs=1e-7)
    assert fix.altitude == pytest.approx(519.25)
    assert fix.variances == pytest.approx((1.5**2, 2.5**2))
    assert (fix.frame, fix.fixed, fix.corrected) == ("gps", True, True)
    assert not driven.receiver.text


def test_receiver_without_a_sky_gives_no_place_and_says_so() -> None:
    driven = DrivenReceiver()
    driven.bus.run(2.0)
    driven.receiver.kind = 0
    driven.bus.run(1.0)
    assert not driven.fixes[-1].fixed
    assert math.isnan(driven.fixes[-1].latitude)
    assert any("does it see the sky?" in line for line in driven.lines)
    assert any("knows where it is (9 satellites)" in line for line in driven.lines)


def test_receiver_that_was_unplugged_or_lost_its_power_is_asked_again() -> None:
    driven = DrivenReceiver()
    driven.bus.run(2.0)
    driven.cable.plugged = False
    driven.bus.run(5.0)
    assert any("unplugged" in line and "u-blox" in line for line in driven.lines)
    count = len(driven.fixes)
    driven.cable.plugged = True
    driven.bus.run(2.0)
    assert len(driven.fixes) > count + 5
    driven.receiver.asked, driven.receiver.text = False, True
    driven.bus.run(6.0)
    assert any("no message of a u-blox receiver" in line for line in driven.lines)
    count = len(driven.fixes)
    driven.bus.run(1.0)
    assert len(driven.fixes) == count + 5
    assert driven.health[-1].open


@pytest.mark.parametrize("seed", range(4))
def test_noise_and_lost_halves_give_no_wrong_place(seed: int) -> None:
    driven = DrivenReceiver()
    driven.bus.run(1.0)
    driven.cable.random, driven.cable.noise, driven.cable.cut = random.Random(seed), 0.002, 0.1
    driven.bus.run(20.0)
    assert len(driven.fixes) > 40
    assert all(each.latitude == pytest.approx(48.1373932, abs=1e-7) for each in driven.fixes)
    driven.cable.noise = driven.cable.cut = 0.0
    driven.bus.run(6.0)
    assert driven.health[-1].damaged < 0.5


def test_line_is_closed_at_the_end() -> None:
    driven = DrivenReceiver()
    driven.bus.run(1.0)
    driven.node.end("the test ends it")
    count = len(driven.fixes)
    driven.bus.run(1.0)
    assert len(driven.fixes) == count


def test_node_needs_a_device() -> None:
    bus = Bus()
    bus.load_parameters("/gnss_driver", {"device": "/nonesuch/gps", "frame": "antenna"})
    node = bus.node("gnss_driver")
    gnss_driver_node.start(node)
    bus.run(0.2)
    assert "/nonesuch/gps: no such file or directory; expected a u-blox receiver" in node.lines[0][1]
