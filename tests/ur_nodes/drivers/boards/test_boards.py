"""The bytes of boards, against the examples of their documents."""

from dataclasses import astuple
from typing import Any

import pytest
from tests.base_contract import load
from tests.ur_nodes.drivers.mutations import StillPlant

from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.robot.base.properties import Wiring
from ur_nodes.drivers.boards.arduino import make_line
from ur_nodes.drivers.boards.board import RewiredBoard
from ur_nodes.drivers.boards.create2 import check
from ur_nodes.drivers.boards.magni import MagniFirmware, make_packet
from ur_nodes.drivers.boards.neato import NeatoFirmware
from ur_nodes.drivers.boards.opencr import OpenCrFirmware
from ur_nodes.drivers.boards.opencr import make_packet as opencr_packet
from ur_nodes.drivers.readings import NOT_MEASURED, Contacts, Counts, DeviceIdentity, MeasuredBeams, Motors, Power
from ur_nodes.drivers.registry import BOARDS


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


@pytest.mark.parametrize(
    ("packet", "text"),
    [  # the examples of the e-Manual, "Read (0x02)" and "Write (0x03)", for the id 1
        (opencr_packet(0x02, 0x84, b"\x04\x00", 1), "ff ff fd 00 01 07 00 02 84 00 04 00 1d 15"),
        (opencr_packet(0x03, 0x74, b"\x00\x02\x00\x00", 1), "ff ff fd 00 01 09 00 03 74 00 00 02 00 00 ca 89"),
    ],
)
def test_packets_of_opencr_are_those_of_its_manuals_examples(packet: bytes, text: str) -> None:
    assert packet == bytes.fromhex(text)


def test_opencr_reads_the_manuals_status_and_stuffs_what_looks_like_a_header() -> None:
    status = bytes.fromhex("ff ff fd 00 01 08 00 55 00 a6 00 00 00 8c c0")
    assert list(make("turtlebot3").receive(status)) == []  # 4 bytes: not what this driver asks for
    packet = opencr_packet(0x03, 0x96, b"\xff\xff\xfd\x01", 1)
    assert b"\xff\xff\xfd\xfd\x01" in packet
    assert packet[5] == 3 + 4 + 1 + 2


def test_opencr_of_another_firmware_is_refused_and_motors_that_do_not_answer_are_reported() -> None:
    firmware = OpenCrFirmware(StillPlant())  # type: ignore[arg-type]
    firmware.power = False
    firmware._table[0:2] = b"\x01\x00"
    board = make("turtlebot3")
    readings = list(board.receive(firmware.receive(board.handshake())))
    assert any(isinstance(each, DeviceIdentity) and "flash the one for ROS 2" in each.problem for each in readings)
    assert any(isinstance(each, Motors) and not each.ready and "power switch" in each.reason for each in readings)


def test_magni_gets_the_speeds_that_ubiquity_motor_sends() -> None:
    # motor_hardware.cc, calculateSpeedFromRadians: 0.5 * radians * 41.004 * 4 / 10 with encoders of 6 states, the left
    # one in the upper half: 5 and -5 rad/s are 41 and -41.
    board = make("magni")
    radius = load("create2", "").wheels.radius
    assert board.drive(5.0 * radius, -5.0 * radius) == bytes.fromhex("7e 3b 2a 00 29 ff d7 9b")


@pytest.mark.parametrize(("options", "fits"), [(1, True), (0, False), (3, False), (9, True)])
def test_magni_with_other_encoders_or_wheels_is_refused(options: int, fits: bool) -> None:
    (identity,) = make("magni").receive(make_packet(0x3C, 0x38, options))
    assert bool(identity.problem) is not fits


@pytest.mark.parametrize("started", [True, False])
def test_magni_stops_by_its_dead_man_timer_where_the_driver_has_started_it(started: bool) -> None:
    class Plant(StillPlant):
        speeds = (0.0, 0.0)

        def turn_wheels(self, left: float, right: float) -> None:
            self.speeds = left, right

    plant, board = Plant(), make("magni")
    firmware = MagniFirmware(plant)  # type: ignore[arg-type]
    firmware.receive((board.handshake() if started else b"") + board.drive(0.2, 0.2))
    plant.time = OWN_DRIVERS["magni"].watchdog - 0.01
    firmware.tick()
    assert plant.speeds != (0.0, 0.0)
    plant.time += 0.02
    firmware.tick()
    assert (plant.speeds == (0.0, 0.0)) is started


def test_magni_adds_up_the_counts_of_its_reports() -> None:
    board = make("magni")
    frames = make_packet(0x3C, 0x30, 3 << 16 | 4) + make_packet(0x3C, 0x30, (-1 & 0xFFFF) << 16 | 2 - (1 << 32))
    assert list(board.receive(frames)) == [Counts(3, 4, 64), Counts(2, 6, 64)]
    assert list(board.receive(make_packet(0x3C, 0x22, 43) + make_packet(0x3C, 0x32, 0))) == [
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
    readings = list(make("create2").receive(b"battery-current 12\r\n" + good))
    assert readings[0] == Counts(0x0102, 0xFFFE, 16)
    assert readings[-1] == Power(14.4, -0.08, 2.8, 3.0, charging=True)
    assert list(make("create2").receive(good[:-1] + b"\x00")) == []


def test_lines_of_an_arduino_have_the_checksum_of_nmea() -> None:
    assert make_line("v 0 0") == b"v 0 0*76\n"
    assert make("arduino").drive(0.36, -0.36).startswith(b"v 810 -810*")
    counts, motors, bumpers, power = make("arduino").receive(make_line("e -5 2147483647 11800 3"))
    assert (counts, motors.ready) == (Counts(-5, 2147483647), False)
    assert astuple(power) == pytest.approx((11.8, NOT_MEASURED, NOT_MEASURED, NOT_MEASURED, False), nan_ok=True)
    assert bumpers.states == (("left", True), ("right", False), ("front", False))


@pytest.mark.parametrize(
    "text", ["e 1 2 3", "e a b c d", "e 1 2 3 4 5", "x", "h ur-base", "", "v 1 2", "e " + "9" * 90]
)
def test_lines_of_an_arduino_that_are_none_are_left_out(text: str) -> None:
    assert not any(isinstance(each, Counts) for each in make("arduino").receive(make_line(text)))


def test_arduino_with_another_sketch_is_told_to_be_flashed() -> None:
    assert [each.problem for each in make("arduino").receive(make_line("h ur-base 2 later"))] == [
        "protocol 2, expected 1: flash the sketch of this release"
    ]


def test_neato_gets_distances_and_the_speed_of_the_wheel_that_goes_farther() -> None:
    # Wiki of the XV-11: "SetMotor 100 200 100 - the robot will move forward and to the left, for 2 seconds".
    left, right, speed = read_motor(make("neato").drive(0.1, 0.2))
    assert (2 * left, speed) == (right, 200)
    assert 0.2 <= right / speed <= 0.35
    assert read_motor(make("neato").drive(float("nan"), -9.0))[1:] == (-60, 300)


def test_neato_stops_by_a_millimetre_to_and_fro_and_then_by_nothing() -> None:
    board = make("neato")
    sent = [board.drive(0.0, 0.0) for _ in range(5)]
    assert [read_motor(each) for each in sent[:3]] == [(-1, -1, 1), (1, 1, 1), (-1, -1, 1)]
    assert not any(b"SetMotor" in each for each in sent[3:])


@pytest.mark.parametrize("left", [0.003, 0.0137, -0.09])
def test_slow_wheels_of_a_neato_turn_as_fast_as_was_asked_on_average(left: float) -> None:
    board, sums = make("neato"), [0.0, 0.0]
    for _ in range(200):
        a, b, speed = read_motor(board.drive(left, 0.02))
        for wheel, way in enumerate((a, b)):
            sums[wheel] += speed * way / max(abs(a), abs(b)) / 200.0 / 1000.0
    assert sums == [pytest.approx(left, abs=0.0005), pytest.approx(0.02, abs=0.0005)]


def read_motor(data: bytes) -> tuple[int, int, int]:
    (line,) = [each for each in data.decode().split("\n") if each.startswith("SetMotor")]
    words = line.split()
    assert words[1::2] == ["LWheelDist", "RWheelDist", "Speed"]
    return int(words[2]), int(words[4]), int(words[6])


def test_neato_reads_answers_as_public_logs_have_them() -> None:
    board = make("neato")
    motors = b"getmotors\r\nParameter,Value\r\nLeftWheel_RPM,0\r\nLeftWheel_Load%,0\r\nLeftWheel_PositionInMM,-12\r\n"
    assert list(board.receive(motors)) == []
    assert list(board.receive(b"RightWheel_PositionInMM,345\r\nRightWheel_Speed,0\r\n\x1a")) == [Counts(-12, 345)]
    digital = b"Digital Sensor Name, Value\r\nSNSR_LEFT_WHEEL_EXTENDED,1\r\nLSIDEBIT,0\r\nLFRONTBIT,1\r\n\x1a"
    bumpers, ready = board.receive(digital)
    assert ("left_front", True) in bumpers.states
    assert not ready.ready
    analog = b"SensorName,Unit,Value\r\nDropSensorLeft,mm,0,\r\nDropSensorRight,mm,120,\r\n\x1a"
    assert list(board.receive(analog)) == [Contacts("cliff", (("left", False), ("right", True)))]
    assert list(board.receive(b"ModelID,-1,XV11,,\r\nSoftware,3,1,17844\r\n\x1a")) == [
        DeviceIdentity("XV11, software 3.1.17844")
    ]


def test_neato_scan_is_a_turn_whose_errors_measured_nothing() -> None:
    rows = [f"{angle},{2378 if angle else 0},82,{0 if angle != 2 else 8021}" for angle in range(360)]
    text = "\r\n".join(["GetLDSScan", "AngleInDegrees,DistInMM,Intensity,ErrorCodeHEX", *rows, "ROTATION_SPEED,5.10"])
    (beams,) = make("neato").receive(text.encode() + b"\r\n\x1a")
    assert isinstance(beams, MeasuredBeams)
    assert beams.complete
    assert beams.turn_time == pytest.approx(1.0 / 5.1)
    assert [beams.ranges[angle] for angle in (0, 1, 2)] == [float("inf"), 2.378, float("inf")]
    short = "\r\n".join([*rows[:100], "ROTATION_SPEED,5.10\r\n\x1a"])
    assert list(make("neato").receive(short.encode())) == []


def test_magni_reads_only_responses_of_registers_that_it_knows() -> None:
    written, unknown = make_packet(0x3B, 0x30, 3 << 16 | 4), make_packet(0x3C, 0x7F, 1)
    assert list(make("magni").receive(written + unknown + make_packet(0x3C, 0x30, 3 << 16 | 4))) == [Counts(3, 4, 64)]


@pytest.mark.parametrize(
    ("wiring", "speeds"),
    [
        (Wiring(motors_swapped=True), (0.2, 0.1)),
        (Wiring(left_motor_reversed=True), (-0.1, 0.2)),
        (Wiring(motors_swapped=True, right_motor_reversed=True), (-0.2, 0.1)),
    ],
    ids=lambda each: "-".join(each.names) if isinstance(each, Wiring) else "",
)
def test_board_gets_the_speeds_of_the_motors_that_turn_its_wheels(wiring: Wiring, speeds: tuple[float, float]) -> None:
    assert RewiredBoard(make("arduino"), wiring).drive(0.1, 0.2) == make("arduino").drive(*speeds)


def test_board_with_a_wiring_counts_damaged_frames_and_passes_on_what_is_no_count() -> None:
    board = RewiredBoard(make("magni"), Wiring(counters_swapped=True, right_counter_reversed=True))
    good = make_packet(0x3C, 0x30, 3 << 16 | 4)
    readings = list(board.receive(good[:-1] + bytes((good[-1] ^ 1,)) + good + make_packet(0x3C, 0x22, 43)))
    assert readings == [Counts(4, -3, 64), DeviceIdentity("firmware 43")]
    assert board.rejected == 1


def error_of(answer: bytes) -> int:
    """The error of a status packet of DYNAMIXEL, after header, id, length and instruction."""
    assert answer[:4] == b"\xff\xff\xfd\x00"
    return answer[8]


def test_stand_in_of_an_opencr_refuses_as_its_manual_says_and_skips_what_is_no_packet() -> None:
    firmware = OpenCrFirmware(StillPlant())  # type: ignore[arg-type]
    assert error_of(firmware.receive(opencr_packet(0x02, 0xFFF0, b"\x04\x00"))) == 7  # data range
    assert error_of(firmware.receive(opencr_packet(0x03, 2, b"\x00"))) == 4  # read only
    assert error_of(firmware.receive(opencr_packet(0x08, 2, b"\x00"))) == 2  # instruction
    good = opencr_packet(0x02, 0, b"\x02\x00")
    assert firmware.receive(b"\xff\xff\xfd\x00\xc8\xff\xff" + good[:-1] + b"\x00" + good) == firmware.receive(good)
    assert error_of(firmware.receive(opencr_packet(0x02, 0, b""))) == 2  # a read without its length


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        ("setmotor lwheeldist x rwheeldist 1 speed 1", "Invalid parameter"),
        ("setmotor lwheeldist 0 rwheeldist 0 speed 100", "Speed and distance must be set"),
    ],
)
def test_stand_in_of_a_neato_refuses_a_motion_that_is_none(words: str, answer: str) -> None:
    firmware = NeatoFirmware(StillPlant())  # type: ignore[arg-type]
    firmware.receive(b"testmode on\n")
    assert answer in firmware.receive(f"{words}\n".encode()).decode()
