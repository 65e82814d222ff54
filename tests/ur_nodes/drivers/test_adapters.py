"""The adapter between a driver and the rest, on a bus."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.base_contract import load

from ur.source.diagnostic import UserError
from ur_nodes.drivers.driver_adapter_node import start
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import DriverOdometry, Joints, Scan, Transform

SECOND = 1_000_000_000
MOVING = DriverOdometry(100 * SECOND, 3.0, 0.0, (0.0, 0.0, 0.0, 1.0), 0.3, 0.0)


def made(kind: str = "", **parameters: Any) -> Bus:
    bus = Bus()
    bus.types = {"neato_node/Sensor": ("value", "name"), "std_msgs/Bool": ("data",)}
    own = parameters | ({"bumper_messages": kind} if kind else {})
    bus.parameters |= {f"/adapter/{name}": value for name, value in own.items()}
    return bus


def started(**parameters: Any) -> Bus:
    bus = made(**parameters)
    start(bus.node("adapter"))
    return bus


def heard(bus: Bus, topic: str, kind: type[Any], quality: Quality = Quality.EVERY) -> list[Any]:
    got: list[Any] = []
    bus.node(f"listener_{len(bus.nodes)}").subscribe(topic, kind, got.append, quality)
    return got


def test_wheels_turn_as_the_odometry_of_the_driver_says() -> None:
    bus = started(base="loki")
    joints, frames = heard(bus, "joint_states", Joints), heard(bus, "/tf", tuple)
    odometry = bus.node("driver").publish("odom", DriverOdometry, Quality.EVERY)
    for number in range(8):
        odometry.send(replace(MOVING, stamp=MOVING.stamp + number * SECOND // 20))
    bus.run(0.1)
    assert joints[0].names == ("left_wheel_joint", "right_wheel_joint")
    radius = load("loki", "").wheels.radius
    rolled = [(b - a) * radius for a, b in zip(joints[0].angles, joints[-1].angles, strict=True)]
    assert rolled == pytest.approx([0.3 * 0.35] * 2, rel=1e-6)
    assert joints[-1].speeds == pytest.approx([10.0, 10.0])
    assert joints[-1].stamp == MOVING.stamp + 7 * SECOND // 20
    assert frames == []  # the driver publishes it itself


def test_frames_of_stage_become_those_of_the_base() -> None:
    bus = started(base="stage", publish_tf=True, rename_scan=True)
    frames, scans = heard(bus, "/tf", tuple), heard(bus, "scan", Scan)
    driver = bus.node("driver")
    driver.publish("odom", DriverOdometry).send(MOVING)
    ranges = np.array([1.0, 2.0], np.float32)
    driver.publish("driver/scan", Scan).send(Scan(5, "base_laser_link", 0.0, 0.1, 0.1, 8.0, ranges))
    bus.run(0.1)
    ((transform,),) = frames
    assert isinstance(transform, Transform)
    assert (transform.stamp, transform.parent, transform.child) == (MOVING.stamp, "odom", "base_footprint")
    assert tuple(transform.pose) == (3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    assert [(scan.stamp, scan.frame, list(scan.ranges)) for scan in scans] == [(5, "laser", [1.0, 2.0])]


@pytest.mark.parametrize(
    "bad",
    [
        replace(MOVING, x=float("nan")),
        replace(MOVING, rotation=(0.0, 0.0, 0.0, 0.9)),
        replace(MOVING, forward=1e6),
        replace(MOVING, turn=float("inf")),
    ],
)
def test_odometry_that_makes_no_sense_is_left_out_and_reported(bad: DriverOdometry) -> None:
    bus = started(base="stage", publish_tf=True)
    joints, frames = heard(bus, "joint_states", Joints), heard(bus, "/tf", tuple)
    bus.node("driver").publish("odom", DriverOdometry).send(bad)
    bus.run(0.1)
    assert joints == frames == []
    (line,) = [text for level, text in bus.nodes["/adapter"].lines if level in ("warn", "error")]
    assert line.startswith(("/odom: odometry is left out", "/odom: message of /driver ignored"))


def test_bumpers_of_neato_become_latched_topics_of_the_base() -> None:
    names = {"Left_Side_Bumper": "left_side", "Left_Bumper": "left_front"}
    bus = started(base="botvac", kind="neato_node/Sensor", bumper_names=names)
    bus.run(0.2)
    left, right = (heard(bus, f"bumper/{side}_front", bool, Quality.LATCHED_EVERY) for side in ("left", "right"))
    sensor = bus.node("driver").publish("driver/bumpers", dict, Quality.EVERY)
    sensor.send({"value": True, "name": "Left_Bumper"})
    sensor.send({"value": True, "name": "Roof"})
    sensor.send({"value": False, "name": "Left_Side_Bumper"})
    bus.run(2.0)
    assert left == [False, True, False]
    assert right == [False]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"base": "lokki"}, "unknown base 'lokki'"),
        ({"base": "botvac", "kind": "nowhere/Sensor"}, "expected a type of message as package/Name"),
        ({"base": "botvac", "kind": "std_msgs/Bool"}, "messages std_msgs/Bool have no name and value"),
        (
            {"base": "botvac", "kind": "neato_node/Sensor", "bumper_names": {"Left_Bumper": "roof"}},
            "expected a map from upstream's names to some of left_side",
        ),
    ],
)
def test_parameters_that_it_cannot_use_are_named(parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message):
        started(**parameters)
