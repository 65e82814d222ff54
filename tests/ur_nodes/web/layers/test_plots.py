"""Plots of pages, on a bus."""

import json
import struct
from typing import Any

import pytest

from ur.web.wire.frames import Kind, Layer, key_of
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.raw import RawMessage
from ur_nodes.web.layers.plots import PlotFeed, list_fields, sample
from ur_nodes.web.messages.definition import read_definition

ODOMETRY, TWIST, BATTERY = "nav_msgs/Odometry", "geometry_msgs/Twist", "sensor_msgs/BatteryState"
SPEED, TURN = "/odom:twist.linear.x", "/odom:twist.angular.z"
LINE = "=" * 80
VECTOR = f"{LINE}\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
SCHEMAS = {
    TWIST: f"Vector3 linear\nVector3 angular\n{VECTOR}",
    ODOMETRY: f"string child\nTwist twist\n{LINE}\nMSG: nav_msgs/Twist\ngeometry_msgs/Vector3 linear\n"
    f"geometry_msgs/Vector3 angular\n{VECTOR}",
    BATTERY: "Header header\nfloat32 voltage\nfloat32 current\nfloat32[] cells\nbool present\nstring location\n"
    f"uint64 cycles\ntime checked\n{LINE}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n",
}


def twist(speed: float, turn: float = 0.0) -> bytes:
    return struct.pack("<6d", speed, 0.0, 0.0, 0.0, 0.0, turn)


def odometry(speed: float) -> bytes:
    return struct.pack("<I", 4) + b"base" + twist(speed)


def battery(voltage: float) -> bytes:
    header = struct.pack("<IIII", 7, 1, 2, 1) + b"b"
    cells = struct.pack("<I3f", 3, 4.0, 4.0, 4.0)
    return header + struct.pack("<ff", voltage, float("nan")) + cells + b"\x01" + struct.pack("<IQII", 0, 2**60, 5, 6)


class Plots:
    def __init__(self) -> None:
        self.bus = Bus()
        self.bus.schemas |= SCHEMAS
        robot = self.bus.node("robot")
        self.odometry = robot.raw.publish("odom", ODOMETRY)
        self.other = robot.raw.publish("cmd_vel", TWIST)
        self.bus.schemas["not_installed/Type"] = "float64 x\n"
        robot.raw.publish("strange", "not_installed/Type")
        del self.bus.schemas["not_installed/Type"]
        self.frames: list[bytes] = []
        self.known = True
        self.node = self.bus.node("web")
        self.feed = PlotFeed(self.node, self.frames.append, self.list_topics)
        self.node.every(0.05, lambda: self.feed.step(self.node.steady()))

    def list_topics(self) -> list[tuple[str, str]]:
        return self.bus.graph().published() if self.known else []

    def take(self, kind: Kind) -> list[Any]:
        """The frames of a kind since they were asked for last."""
        self.bus.run(0.5)
        assert all(key_of(frame)[1] == Layer.PLOTS for frame in self.frames)
        found = [json.loads(frame[6:]) for frame in self.frames if key_of(frame)[0] == kind]
        self.frames.clear()
        return found


def test_numeric_fields_of_a_message_are_found_without_headers_and_arrays() -> None:
    expected = [f"{part}.{axis}" for part in ("linear", "angular") for axis in "xyz"]
    assert list_fields(read_definition(TWIST, SCHEMAS[TWIST])) == expected
    assert list_fields(read_definition(BATTERY, SCHEMAS[BATTERY])) == ["voltage", "current", "present", "cycles"]
    assert list_fields(read_definition(ODOMETRY, SCHEMAS[ODOMETRY]), 2) == []


@pytest.mark.parametrize(
    ("path", "number"),
    [
        ("voltage", 12.5),
        ("present", 1.0),
        ("cycles", 1.15292e18),
        *((path, None) for path in ("location", "current", "cells", "voltage.real", "_x", "header", "checked", "")),
    ],
)
def test_number_is_read_only_from_a_numeric_field(path: str, number: float | None) -> None:
    assert sample(RawMessage(BATTERY, SCHEMAS[BATTERY], battery(12.5)), path) == number


@pytest.mark.parametrize(
    "message",
    [
        RawMessage(BATTERY, SCHEMAS[BATTERY], battery(12.5)[:10]),
        RawMessage(BATTERY, "no definition", battery(12.5)),
        RawMessage(BATTERY, SCHEMAS[BATTERY], battery(12.5) + bytes(1 << 20)),
    ],
)
def test_message_that_cannot_be_read_has_no_numbers(message: RawMessage) -> None:
    assert sample(message, "voltage") is None


def test_plots_are_sampled_while_they_are_wanted() -> None:
    plots = Plots()
    plots.feed.want([SPEED, TURN, "/strange:x", "no plot"], shown=False)
    plots.bus.run(0.5)
    assert (plots.odometry.subscribers(), plots.other.subscribers()) == (1, 0)
    for speed in (0.1, 0.2):
        plots.odometry.send(odometry(speed))
    assert [each["v"] for each in plots.take(Kind.VALUES)] == [{SPEED: 0.2, TURN: 0.0}]
    assert plots.take(Kind.VALUES) == [], "no sample without a message"
    plots.feed.want([], shown=False)
    plots.bus.run(4.0)
    assert plots.odometry.subscribers() == 0


def test_messages_that_take_long_to_read_are_read_beside_the_node_one_sample_at_a_time() -> None:
    plots = Plots()
    plots.bus.durations["plots"] = 0.35
    plots.feed.want([SPEED], shown=False)
    plots.bus.run(0.5)
    plots.bus.node("base").every(0.02, lambda: plots.odometry.send(odometry(0.1)))
    plots.bus.run(0.3)
    assert plots.frames == []
    plots.bus.run(1.2)
    assert len(plots.frames) == 3


def test_message_of_another_type_than_the_field_has_no_numbers() -> None:
    plots = Plots()
    plots.feed.want(["/cmd_vel:twist.linear.x"], shown=False)
    plots.bus.run(0.5)
    plots.other.send(twist(0.5))
    assert plots.take(Kind.VALUES) == []


def test_fields_are_offered_while_a_page_chooses() -> None:
    plots = Plots()
    plots.feed.want([], shown=True)
    (offered,) = plots.take(Kind.FIELDS)
    assert set(offered["fields"]) == {"/cmd_vel", "/odom"}
    assert "twist.linear.x" in offered["fields"]["/odom"]
    plots.bus.run(5.0)
    assert plots.take(Kind.FIELDS) == [], "they have not changed"


def test_fields_are_offered_as_soon_as_topics_are_known() -> None:
    plots = Plots()
    plots.known = False
    plots.feed.want([], shown=True)
    assert plots.take(Kind.FIELDS) == []
    plots.known = True
    (offered,) = plots.take(Kind.FIELDS)
    assert offered["fields"]
