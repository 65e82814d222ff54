"""The bytes of boards, against the examples of their documents."""

from __future__ import annotations

from typing import Any

import pytest
from tests.base_contract import load

from ur_nodes.drivers.boards import BOARDS
from ur_nodes.drivers.boards.arduino import make_line
from ur_nodes.drivers.boards.create2 import check
from ur_nodes.drivers.boards.magni import make_packet
from ur_nodes.drivers.readings import Counts, DeviceIdentity, Motors, Power


def make(name: str) -> Any:
    return BOARDS[name](load("create2", ""))


@pytest.mark.parametrize(
    ("packet", "text"),
    [
        (make_packet(0x3A, 0x21), "7e 3a 21 00 00 00 00 a4"),
        (make_packet(0x3B, 0x21), "7e 3b 21 00 00 00 00 a3"),
        (make_packet(0x3B, 0x2A, -568), "7e 3b 2a ff ff fd c8 d7"),
    ],
)
def test_packets_of_magni_are_those_of_its_protocols_examples(packet: bytes, text: str) -> None:
    assert packet == bytes.fromhex(text)


def test_magni_gets_the_speeds_that_ubiquity_motor_sends() -> None:
    # motor_hardware.cc, calculateSpeedFromRadians: 0.5 * radians * 41.004 * 4 / 10 with encoders of 6 states, the left
    # one in the upper half: 5 and -5 rad/s are 41 and -41.
    board = make("magni")
    radius = load("create2", "").wheels.radius
    assert board.drive(5.0 * radius, -5.0 * radius) == bytes.fromhex("7e 3b 2a 00 29 ff d7 9b")


@pytest.mark.parametrize(("options", "fits"), [(1, True), (0, False), (3, False), (9, True)])
def test_magni_with_other_encoders_or_wheels_is_refused(options: int, fits: bool) -> None:
    (identity,) = make("magni").take(make_packet(0x3C, 0x38, options))
    assert bool(identity.problem) is not fits


def test_magni_adds_up_the_counts_of_its_reports() -> None:
    board = make("magni")
    frames = make_packet(0x3C, 0x30, 3 << 16 | 4) + make_packet(0x3C, 0x30, (-1 & 0xFFFF) << 16 | 2 - (1 << 32))
    assert list(board.take(frames)) == [Counts(3, 4, 64), Counts(2, 6, 64)]
    assert list(board.take(make_packet(0x3C, 0x22, 43) + make_packet(0x3C, 0x32, 0))) == [
        DeviceIdentity("firmware 43"),
        Motors(False, "its motors have no power (emergency stop?)"),
    ]


def test_create_drives_in_mm_a_second_the_right_wheel_first() -> None:
    # The specification's example of Drive Direct's units: high byte first, right, then left, at most 500 mm/s.
    assert make("create2").drive(-0.2, 0.3) == bytes((145, 0x01, 0x2C, 0xFF, 0x38))
    assert make("create2").drive(9.0, float("nan")) == bytes((145, 0, 0, 0x01, 0xF4))


def test_checksum_of_the_stream_is_that_of_the_example_of_the_specification() -> None:
    # "iRobot Create 2 Open Interface", Stream: 19 + 5 + 29 + 2 + 25 + 13 + 0 + 163 = 256. The example of the first
    # Create's document has 182 in place of 163: its checksum leaves the 19 out.
    assert check(bytes((19, 5, 29, 2, 25, 13, 0, 163)))
    assert not check(bytes((19, 5, 29, 2, 25, 13, 0, 182)))


def test_create_reads_a_frame_whose_sum_is_zero_and_no_other() -> None:
    values = bytes.fromhex("0700 0900 0a00 0b00 0c00 1502 163840 17ffb0 190af0 1a0bb8 2302 2b0102 2cfffe")
    frame = bytes((19, len(values))) + values
    good = frame + bytes((-sum(frame) & 0xFF,))
    readings = list(make("create2").take(b"battery-current 12\r\n" + good))
    assert readings[0] == Counts(0x0102, 0xFFFE, 16)
    assert readings[-1] == Power(14.4, -0.08, 2.8, 3.0, charging=True)
    assert list(make("create2").take(good[:-1] + b"\x00")) == []


def test_lines_of_an_arduino_have_the_checksum_of_nmea() -> None:
    assert make_line("v 0 0") == b"v 0 0*76\n"
    assert make("arduino").drive(0.36, -0.36).startswith(b"v 810 -810*")
    counts, motors, bumpers, power = make("arduino").take(make_line("e -5 2147483647 11800 3"))
    assert (counts, motors.ready, power) == (Counts(-5, 2147483647), False, Power(11.8))
    assert bumpers.states == (("left", True), ("right", False), ("front", False))


@pytest.mark.parametrize(
    "text", ["e 1 2 3", "e a b c d", "e 1 2 3 4 5", "x", "h ur-base", "", "v 1 2", "e " + "9" * 90]
)
def test_lines_of_an_arduino_that_are_none_are_left_out(text: str) -> None:
    assert not any(isinstance(each, Counts) for each in make("arduino").take(make_line(text)))


def test_arduino_with_another_sketch_is_told_to_be_flashed() -> None:
    assert [each.problem for each in make("arduino").take(make_line("h ur-base 2 later"))] == [
        "protocol 2, expected 1: flash the sketch of this release"
    ]
