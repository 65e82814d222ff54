"""The bytes of lidars, against the examples and tables of their documents."""

import math
import struct
from dataclasses import replace

import numpy as np
import pytest
from tests.base_contract import load

from ur_nodes.drivers.lidars.ldrobot import check
from ur_nodes.drivers.lidars.scip import Scip, decode
from ur_nodes.drivers.lidars.scip import check as scip_check
from ur_nodes.drivers.lidars.turns import TurnCollector
from ur_nodes.drivers.lidars.ydlidar import correction
from ur_nodes.drivers.readings import DeviceIdentity, MeasuredBeams, Reply
from ur_nodes.drivers.registry import LIDARS

# The worked example of the LD06's manual.
LD06 = bytes.fromhex("542c6808ab7ee000e4dc00e2d900e5d500e3d300e4d000e9cd00e4ca00e2c700e9c500e5c200e5c000e5be823a1a50")


def read(name: str, data: bytes) -> MeasuredBeams:
    (beams,) = (each for each in LIDARS[name]().receive(data) if isinstance(each, MeasuredBeams))
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


@pytest.mark.parametrize("line", ["AMIN:44;7", "AMAX:725;o", "AFRT:384;6", "SCAN:600;e", "DMAX:5600;_"])
def test_sums_of_scip_are_those_of_its_examples(line: str) -> None:
    body, _, end = line.partition(";")
    assert chr(scip_check(body.encode())) == end
    assert decode(b"1Dh").tolist() == [5432]  # the example of the specification: 5432 mm


def test_hokuyo_asks_for_the_steps_of_its_model_and_leaves_out_damaged_lines() -> None:
    lidar = Scip()
    rows = ("DMIN:20;4", "DMAX:5600;_", "ARES:1024;\\", "AMIN:44;7", "AMAX:725;o", "AFRT:384;6", "SCAN:600;e")
    (reply,) = lidar.receive(("PP\n00P\n" + "\n".join(rows) + "\n\n").encode())
    assert reply == Reply(b"MD0044072500000\n")
    scan = b"".join(row + bytes((scip_check(row), 10)) for row in (b"0000", *[b"1Dh" * 21] * 32, b"1Dh" * 10))
    (beams,) = lidar.receive(b"MD0044072500000\n99b\n" + scan + b"\n")
    assert isinstance(beams, MeasuredBeams)
    assert len(beams.ranges) == 682
    assert beams.ranges[0] == 5.432
    assert np.degrees(beams.phases[340]) == pytest.approx(0.0)
    assert beams.turn_time == pytest.approx(0.1)
    (beams,) = lidar.receive(b"MD0044072500000\n99b\n" + scan.replace(b"1Dh", b"1Di", 1) + b"\n")
    assert isinstance(beams, MeasuredBeams)
    assert np.isnan(beams.ranges[:21]).all()
    assert not np.isnan(beams.ranges[21:]).any()
    assert list(lidar.receive(b"MD0044072500000\n99b\n" + scan[:-20] + b"\n\n")) == []
    assert lidar.rejected == 2


def test_hokuyo_that_refuses_to_measure_is_named() -> None:
    (identity,) = Scip().receive(b"MD0044072500000\n0Aq\n\n")
    assert identity == DeviceIdentity("", "it refuses to measure (status 0A); switch it off and on again")


def test_standard_sample_of_an_rplidar_has_64ths_of_a_degree_and_quarters_of_mm() -> None:
    sample = struct.pack("<BHH", 47 << 2 | 2, (90 * 64 + 32) << 1 | 1, 4001)
    beams = read("rplidar", sample * 5)
    assert np.degrees(beams.phases[0]) == pytest.approx(90.5)
    assert beams.ranges[0] == pytest.approx(1.00025)
    assert beams.intensities[0] == 47.0


def express_packet(start: int, cabin: str) -> bytes:
    """A packet of the express scan, of 16 equal cabins; `start` in 64ths of a degree."""
    body = struct.pack("<H", start) + bytes.fromhex(cabin) * 16
    total = 0
    for byte in body:
        total ^= byte
    return bytes((0xA0 | total & 15, 0x50 | total >> 4)) + body


def test_beams_of_an_express_scan_have_the_angles_of_slamtecs_sdk() -> None:
    # rplidar_sdk, handler_capsules.cpp: the offset is the low nibble (the high one for the second beam) and the two low
    # bits of the distance above it, without a sign; (step << 16) * k - (offset << 13) in 65536ths of a degree, and then
    # 64ths of one. Cabin: 1000 mm with offset 0x13, 2000 mm with offset 0x28.
    data = express_packet(350 * 64, "a10f 421f 83") + express_packet(22 * 64, "a10f 421f 83")
    beams = read("rplidar_express", data)
    expected = [(350 << 16) - (0x13 << 13) >> 10, (351 << 16) - (0x28 << 13) >> 10, (352 << 16) - (0x13 << 13) >> 10]
    assert np.degrees(beams.phases[:3]).tolist() == pytest.approx([each / 64.0 for each in expected])
    assert beams.ranges[:3].tolist() == [1.0, 2.0, 1.0]
    assert beams.clockwise


def test_packet_of_a_ydlidar_has_the_checksum_and_angles_of_the_example_of_its_protocol() -> None:
    # YDLidar-SDK-Communication-Protocol.md: the example without intensity, a packet of its zero; and the angles of the
    # first-level analysis: 28 E5 6F BD 79 are 40 samples from 223.78 to 243.47 degrees.
    beams = read("ydlidar", bytes.fromhex("aa55 0101 53ae 53ae ab54 0000"))
    assert np.degrees(beams.phases).tolist() == pytest.approx([0xAE53 // 2 / 64.0])
    assert beams.ranges.tolist() == [math.inf]
    words = [0x55AA, 0x2800, 0x6FE5, 0x79BD, *([0x6FE5] * 40)]
    total = 0
    for word in words:
        total ^= word
    beams = read("ydlidar", struct.pack("<45H", *words[:4], total, *words[4:]))
    assert beams.ranges[0] == pytest.approx(7.16125)
    degrees = np.degrees(beams.phases) - correction(beams.ranges * 1000.0)
    assert (degrees[0], degrees[-1]) == pytest.approx((223.78, 243.47), abs=0.02)


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


def test_packet_of_an_lds_01_has_six_beams_a_degree_apart_clockwise_from_one_degree() -> None:
    # hls_lfcd_lds_driver: beam 0 of packet 0 is at 359 degrees, counter-clockwise.
    beams = read("lds01", struct.pack("<BBH", 0xFA, 0xA0 + 1, 3000) + struct.pack("<3H", 700, 1234, 0) * 5 + bytes(8))
    assert np.degrees(beams.phases).tolist() == pytest.approx([7.0, 8.0, 9.0, 10.0, 11.0, 12.0])
    assert beams.ranges.tolist() == [1.234] * 5 + [math.inf]
    assert (beams.clockwise, beams.turn_time, beams.intensities[0]) == (True, 0.2, 700.0)


def test_beams_of_an_lds_02_are_corrected_as_ld08_driver_does() -> None:
    # transform.cpp: x = d + 5.9, y = 0.11923 d - 20.14; the angle is 360 - that of the frame + atan(y / x).
    frame = (
        struct.pack("<BBHH", 0x54, 0x2C, 1800, 9000) + struct.pack("<HB", 1000, 200) * 12 + struct.pack("<HH", 9880, 7)
    )
    beams = read("lds02", frame + bytes((check(frame),)))
    x, y = 1005.9, 99.09
    assert beams.ranges[0] == pytest.approx(math.hypot(x, y) / 1000.0)
    assert np.degrees(beams.phases[0]) == pytest.approx(90.0 - math.degrees(math.atan(y / x)))


def test_lidar_counts_the_frames_that_noise_has_damaged() -> None:
    damaged = LD06[:-1] + bytes((LD06[-1] ^ 1,))
    lidar = LIDARS["ld06"]()
    assert len(list(lidar.receive(damaged + LD06))) == 1
    assert lidar.rejected == 1
    lidar = LIDARS["ydlidar"]()
    good = bytes.fromhex("aa55 0101 53ae 53ae ab54 0000")
    assert len(list(lidar.receive(good[:-1] + b"\x01" + good))) == 1
    assert lidar.rejected == 1


@pytest.mark.parametrize(
    ("name", "sent"), [("ld06", b""), ("xv11", b""), ("hokuyo", b"\nQT\n"), ("ydlidar", b"\xa5\x65"), ("lds01", b"e")]
)
def test_lidar_is_told_to_stop_at_the_end_where_it_has_a_command_for_it(name: str, sent: bytes) -> None:
    assert LIDARS[name]().shutdown() == sent


def test_hokuyo_ignores_the_answer_to_a_request_that_it_does_not_use() -> None:
    assert list(Scip().receive(b"II\n00P\nMODL:URG-04LX;A\n\nMD0044072500000\n00P\n\n")) == []


def test_packet_without_beams_completes_no_turn() -> None:
    lidar = load("create2", "lidar").lidar
    assert lidar
    collector = TurnCollector(lidar)
    nothing = MeasuredBeams(np.zeros(0), np.zeros(0), np.zeros(0), complete=True)
    assert collector.add(nothing, 1_000_000_000) == []


def test_scans_of_a_lidar_that_is_turned_begin_at_a_later_angle_and_have_the_same_beams() -> None:
    lidar = load("create2", "lidar").lidar
    assert lidar
    phases = np.linspace(0.0, 2.0 * math.pi, 360, endpoint=False)
    table = MeasuredBeams(phases, 1.0 + phases, phases, turn_time=0.2, complete=True)
    straight, turned = (
        TurnCollector(each).add(table, 1_000_000_000)[0] for each in (lidar, replace(lidar, askew=0.05))
    )
    assert turned.angle_min == pytest.approx(straight.angle_min + 0.05)
    assert turned.angle_max == pytest.approx(lidar.angle_max + 0.05)
    assert np.array_equal(turned.ranges, straight.ranges, equal_nan=True)
