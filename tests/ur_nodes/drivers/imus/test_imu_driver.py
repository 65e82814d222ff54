"""The driver of inertial units behind stand-ins: their readings, their zero, and their faults."""

import math
import random
from collections.abc import Callable
from typing import Any

import pytest
from tests.base_contract import load
from tests.ur_nodes.drivers.imus.units import BoschUnit, InvenSenseUnit, Unit

from ur.devices.driver_health import DriverHealth
from ur_nodes.drivers.imus.bno055 import Bno055
from ur_nodes.drivers.imus.imu_driver import ImuDriver
from ur_nodes.drivers.imus.mpu6050 import Mpu6050
from ur_nodes.drivers.registry import IMUS
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.values import Imu

DEVICE = "/dev/i2c-1"
UNITS: dict[str, Callable[[], Any]] = {"bno055": BoschUnit, "mpu6050": InvenSenseUnit}
KINDS: dict[str, Any] = {"bno055": Bno055, "mpu6050": Mpu6050}
NAMES = sorted(UNITS)


class DrivenUnit:
    """A driver on a bus, and its unit."""

    def __init__(self, name: str) -> None:
        self.bus = Bus()
        self.unit: Unit = UNITS[name]()
        self.readings: list[Imu] = []
        self.health: list[DriverHealth] = []
        self.bus.node("world").subscribe("imu/data", Imu, self.readings.append)
        self.node = self.bus.node("imu_driver")
        imu = load("stage", "").imu
        assert imu
        kind = KINDS[name](sleep=lambda _: None)
        ImuDriver(self.node, imu, kind, (DEVICE, self.unit.open), self.health.append)

    @property
    def lines(self) -> list[str]:
        return [text for _, text in self.node.lines]


def test_every_unit_is_tried() -> None:
    assert sorted(IMUS) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_readings_are_what_the_unit_measured_in_si_units_at_the_rate_of_the_base_file(name: str) -> None:
    driven = DrivenUnit(name)
    driven.bus.run(2.0)
    driven.unit.turning, driven.unit.force = (0.1, -0.2, 1.5), (0.5, -1.0, 9.7)
    driven.readings.clear()
    driven.bus.run(1.0)
    assert 48 <= len(driven.readings) <= 51
    last = driven.readings[-1]
    assert last.turning == pytest.approx((0.1, -0.2, 1.5), abs=0.002)
    assert last.force == pytest.approx((0.5, -1.0, 9.7), abs=0.01)
    assert last.frame == "imu"
    assert last.stamp == pytest.approx(driven.bus.now, abs=25_000_000)
    assert last.turning_variance == pytest.approx(1e-6)


def test_orientation_of_a_bno055_is_its_own_and_a_mpu6050_has_none() -> None:
    driven = DrivenUnit("bno055")
    driven.unit.orientation = (math.cos(0.4), 0.0, 0.0, math.sin(0.4))
    driven.bus.run(1.0)
    assert driven.readings[-1].orientation == pytest.approx((0.0, 0.0, math.sin(0.4), math.cos(0.4)), abs=1e-4)
    assert driven.readings[-1].orientation_variance > 0.0
    driven = DrivenUnit("mpu6050")
    driven.bus.run(2.0)
    assert driven.readings[-1].orientation_variance == -1.0


def test_gyroscope_that_is_off_is_taken_as_zero_once_it_rests() -> None:
    driven = DrivenUnit("mpu6050")
    driven.unit.turning = (0.2, -0.1, 0.05)
    source = random.Random(1)
    for _ in range(40):  # it is carried
        driven.unit.turning = (source.random(), 0.0, source.random())
        driven.bus.run(0.1)
    assert driven.readings == []
    assert any("does the robot rest" in line for line in driven.lines)
    driven.unit.turning = (0.2, -0.1, 0.05)
    driven.bus.run(1.5)
    assert driven.readings[-1].turning == pytest.approx((0.0, 0.0, 0.0), abs=0.001)
    driven.unit.turning = (0.2, -0.1, 1.05)
    driven.bus.run(0.1)
    assert driven.readings[-1].turning == pytest.approx((0.0, 0.0, 1.0), abs=0.003)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("seed", range(3))
def test_unit_that_is_unplugged_or_loses_its_power_is_set_up_again(name: str, seed: int) -> None:
    driven = DrivenUnit(name)
    driven.bus.run(2.0 + random.Random(seed).random())
    driven.unit.plugged = False
    driven.bus.run(5.0)
    (line,) = [each for each in driven.lines if "remote i/o error" in each]
    assert line.startswith(f"{DEVICE}: remote i/o error; expected a ")
    assert "dtparam=i2c_arm=on" in line
    assert not driven.health[-1].open
    driven.unit.plugged = True
    driven.unit.lose_power()
    driven.readings.clear()
    driven.bus.run(4.0)
    assert len(driven.readings) > 50
    driven.unit.lose_power()
    driven.bus.run(4.0)
    driven.readings.clear()
    driven.bus.run(1.0)
    assert len(driven.readings) > 45


@pytest.mark.parametrize("name", NAMES)
def test_other_chip_at_the_address_is_refused(name: str) -> None:
    driven = DrivenUnit(name)
    driven.unit.plugged = False
    driven.bus.run(1.0)
    driven.unit.registers[0x75 if name == "mpu6050" else 0] = 0x12
    driven.unit.plugged = True
    driven.bus.run(6.0)
    assert driven.readings == []
    assert any("is 0x12, expected" in line for line in driven.lines)
    assert "0x12" in driven.health[-1].problem


def test_nonsense_that_a_raspberry_pi_reads_of_a_bno055_is_left_out() -> None:
    driven = DrivenUnit("bno055")
    driven.unit.random, driven.unit.noise = random.Random(5), 0.01
    driven.bus.run(10.0)
    assert 300 < len(driven.readings) < 500
    for each in driven.readings:
        assert math.hypot(*each.orientation) == pytest.approx(1.0)
    assert driven.health[-1].damaged > 0.5


@pytest.mark.parametrize("name", NAMES)
def test_bus_is_closed_at_the_end(name: str) -> None:
    driven = DrivenUnit(name)
    driven.bus.run(1.0)
    driven.node.end("the test ends it")
    assert driven.unit.closed == 1
