"""The bytes of lidars, against the examples and tables of their documents."""

from __future__ import annotations

import math
import struct

import numpy as np
import pytest

from ur_nodes.drivers.lidars import LIDARS
from ur_nodes.drivers.lidars.ldrobot import check
from ur_nodes.drivers.lidars.rplidar import read_cabins
from ur_nodes.drivers.lidars.ydlidar import correction
from ur_nodes.drivers.readings import Beams

# The worked example of the LD06's manual.
LD06 = bytes.fromhex("542c6808ab7ee000e4dc00e2d900e5d500e3d300e4d000e9cd00e4ca00e2c700e9c500e5c200e5c000e5be823a1a50")


def read(name: str, data: bytes) -> Beams:
    (beams,) = (each for each in LIDARS[name]().take(data) if isinstance(each, Beams))
    return beams


def test_example_of_the_manual_of_an_ld06_is_read() -> None:
    assert check(LD06[:-1]) == LD06[-1]
    beams = read("ld06", LD06)
    degrees = np.degrees(beams.phases)
    assert degrees[0] == pytest.approx(324.27)
    assert degrees[-1] == pytest.approx(334.7)
    assert beams.ranges[:2].tolist() == pytest.approx([0.224, 0.220])
    assert beams.clockwise
    assert beams.turn_time == pytest.approx(360.0 / 2152)


def test_standard_sample_of_an_rplidar_has_64ths_of_a_degree_and_quarters_of_mm() -> None:
    sample = struct.pack("<BHH", 47 << 2 | 2, (90 * 64 + 32) << 1 | 1, 4001)
    beams = read("rplidar", sample * 5)
    assert np.degrees(beams.phases[0]) == pytest.approx(90.5)
    assert beams.ranges[0] == pytest.approx(1.00025)
    assert beams.intensities[0] == 47.0


def test_cabins_of_an_rplidar_have_corrections_with_a_sign() -> None:
    cabins = np.zeros(16, [("first", "<u2"), ("second", "<u2"), ("corrections", "u1")])
    cabins[0] = (1000 << 2 | 0b01, 2000 << 2 | 0b10, 0x83)  # + 19/8 degrees, - 8/8 degrees
    beams = read_cabins(cabins, 350.0, 32.0)
    assert np.degrees(beams.phases[:3]).tolist() == pytest.approx([350.0 - 19 / 8, 351.0 + 1.0, 352.0])
    assert beams.ranges[:3].tolist() == [1.0, 2.0, math.inf]


def test_correction_of_a_ydlidar_is_that_of_its_manual() -> None:
    # X4: distance 1000 mm corrects by -6.7622 degrees, 8000 mm by -7.8374; 0 by nothing.
    assert correction(np.array([1000.0, 8000.0, 0.0])).tolist() == pytest.approx([-6.7622, -7.8374, 0.0], abs=0.001)


def test_readings_of_an_xv11_that_are_invalid_see_nothing() -> None:
    body = struct.pack("<BBH8H", 0xFA, 0xA0 + 89, 300 * 64, 500, 9, 0x8035, 0, 0, 0, 0x4000 | 700, 20)
    total = 0
    for (word,) in struct.iter_unpack("<H", body):
        total = (total << 1) + word
    beams = read("xv11", b"\xfa" + body + struct.pack("<H", ((total & 0x7FFF) + (total >> 15)) & 0x7FFF))
    assert np.degrees(beams.phases).tolist() == pytest.approx([356.0, 357.0, 358.0, 359.0])
    assert beams.ranges.tolist() == [0.5, math.inf, math.inf, 0.7]
    assert beams.turn_time == pytest.approx(0.2)
