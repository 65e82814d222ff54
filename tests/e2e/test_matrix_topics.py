"""What the matrix takes for right and for wrong: rates, trees of frames, and the table worked out for a base."""

import struct
from typing import Any

import pytest
from tests.e2e.matrix_table import Topic, list_all_bases, load_cells, make_cell
from tests.e2e.matrix_topics import Heard, find_fault, find_tree_faults, read_stamp, read_transforms

from ur.request.programs import PACKAGE, choose_program, list_programs
from ur.robot.base import load_base

TREE = {"odom": {"map"}, "base": {"odom"}, "laser": {"base"}}


def heard(*stamps: float) -> Heard:
    return Heard(list(stamps), list(stamps))


def at_rate(rate: float, count: int) -> Heard:
    return heard(*(number / rate for number in range(count)))


@pytest.mark.parametrize("rate", [8.5, 10.0, 11.5])
def test_rate_within_a_fifth_is_right(rate: float) -> None:
    assert find_fault(Topic("/scan", 10.0), at_rate(rate, 30)) == ""


@pytest.mark.parametrize("rate", [5.0, 20.0])
def test_other_rate_is_told(rate: float) -> None:
    assert find_fault(Topic("/scan", 10.0), at_rate(rate, 60)) == f"/scan: {rate:.1f} messages a second, expected 10"


def test_faster_than_at_least_is_right() -> None:
    assert find_fault(Topic("/image", 5.0, at_least=True), at_rate(30.0, 60)) == ""
    assert find_fault(Topic("/image", 5.0, at_least=True), at_rate(2.0, 60))


def test_single_messages_that_were_dropped_do_not_matter() -> None:
    stamps = [number / 10.0 for number in range(40) if number % 5]
    assert find_fault(Topic("/scan", 10.0), heard(*stamps)) == ""


def test_messages_with_one_stamp_count_together() -> None:
    stamps = [turn / 5.0 for turn in range(8) for _ in range(16)]
    assert find_fault(Topic("/sonars", 80.0), heard(*stamps)) == ""


def test_too_little_is_no_rate_yet() -> None:
    assert find_fault(Topic("/scan", 10.0), at_rate(10.0, 5)) == "/scan: 5 messages came, expected 10 a second"
    assert find_fault(Topic("/map"), heard()) == "/map: nothing came"
    assert find_fault(Topic("/map"), heard(1.0)) == ""


def test_one_tree_with_what_is_wanted_is_right() -> None:
    assert find_tree_faults(TREE, "map", ["laser", "map"]) == []


@pytest.mark.parametrize(
    ("change", "root", "fault"),
    [
        ({}, "odom", "roots of the frames: map, expected odom"),
        ({"imu": {"body"}}, "map", "roots of the frames: body, map, expected map"),
        ({"base": {"odom", "map"}}, "map", "frame base has the parents map, odom, expected one"),
        ({"map": {"laser"}}, "map", "roots of the frames: none, expected map"),
    ],
)
def test_what_is_no_tree_is_told(change: dict[str, set[str]], root: str, fault: str) -> None:
    assert find_tree_faults(TREE | change, root, []) == [fault]


def test_frame_that_is_not_there_is_told() -> None:
    (fault,) = find_tree_faults(TREE, "map", ["imu"])
    assert fault.startswith("frames that are not there: imu")


def test_stamps_and_transforms_are_read_from_messages() -> None:
    header = struct.pack("<III", 7, 12, 500_000_000)
    assert read_stamp(header + b"rest") == pytest.approx(12.5)
    assert read_stamp(b"") == 0.0
    names = b"".join(struct.pack("<I", len(name)) + name for name in (b"/odom", b"base"))
    assert read_transforms(struct.pack("<I", 1) + header + names + bytes(56)) == [("odom", "base")]


GROUPS: dict[str, Any] = {
    "all": {
        "topics": {
            "odom": {"rate": "odometry.rate"},
            "{sonars.topic}": {"needs": "sonars", "rate": "sonars.rate", "per": "sonars.at"},
            "{bumpers.topic}/{each.name}": {"needs": "bumpers", "each": "bumpers.at"},
        },
        "frames": {"{lidar.frame}": {"needs": "lidar"}},
    }
}


def test_table_is_worked_out_from_the_base() -> None:
    program = choose_program(list_programs(PACKAGE / "bin"), "robot_base")
    loki = make_cell(program, load_base(PACKAGE, "loki"), {"groups": ["all"]}, GROUPS)
    assert loki.topics[1] == Topic("/sonars", 80.0)
    assert loki.frames == ()
    botvac = make_cell(program, load_base(PACKAGE, "botvac"), {"groups": ["all"]}, GROUPS)
    assert Topic("/bumper/left_side") in botvac.topics
    assert botvac.frames == ("laser",)


def test_table_knows_every_program() -> None:
    cells = load_cells(list_all_bases())
    assert {cell.program.name for cell in cells} == {program.name for program in list_programs(PACKAGE / "bin")}
    assert len(cells) >= 84
