"""No value that a program may send ends a node or moves the robot: on every topic, action and service of every node."""

import math
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.ur_nodes.odd_values.generator import hints_of, odd_values, usable_value
from tests.ur_nodes.odd_values.started import MODULES, StartedNode
from tests.ur_nodes.odd_values.stranger import oddities, usable

from ur.robot.base import load_base
from ur.source.project import launch_library
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.motion.obstacle_stop.guard import Guard
from ur_nodes.motion.obstacle_stop.obstacle_stop import ObstacleStop
from ur_nodes.motion.writes import Writes
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Odometry, Result, Scan, Twist

ASIDE = ("/odd/write",)
"""Of the black box, which answers once another process has written a file."""


class Trial:
    """Sends odd values to a node, between usable ones on all its topics."""

    def __init__(self, started: StartedNode) -> None:
        self.started, self.bus = started, started.bus
        self.publishers: dict[str, Any] = {}

    def send(self, topic: str, kind: Any, value: Any) -> None:
        if topic not in self.publishers:
            self.publishers[topic] = self.bus.node("stranger").publish(topic, kind, Quality.LATCHED)
        self.publishers[topic].send(value)

    def run(self, seconds: float, what: str) -> None:
        """Let time pass, in which the node neither fails nor ends nor moves the robot."""
        try:
            self.bus.run(seconds)
        except Exception as problem:
            raise AssertionError(f"{what} ends the node") from problem
        assert self.started.node.ended is None, what
        assert not self.started.motions, what

    def refresh(self) -> None:
        for topic, kind in self.started.topics().items():
            self.send(topic, kind, usable(kind, self.bus.now))
        self.run(0.1, "usable values")

    def try_topics(self) -> None:
        tried: set[str] = set()
        while new := {topic: kind for topic, kind in self.started.topics().items() if topic not in tried}:
            tried |= set(new)
            for topic, kind in new.items():
                for index, value in enumerate(oddities(kind, usable(kind, self.bus.now))):
                    if index % 10 == 0:
                        self.refresh()
                        self.started.watch()
                    self.send(topic, kind, value)
                    self.run(0.02, f"{topic}: {value!r}"[:150])

    def try_services(self) -> None:
        for service, kind in self.started.services().items():
            self.refresh()
            if service in ASIDE:
                continue
            for value in oddities(kind, usable(kind, self.bus.now)):
                got: list[Result] = []
                self.started.world.call(service, value, got.append)
                what = f"{service}: {value!r}"[:150]
                self.run(0.1, what)
                if not got:
                    self.run(10.0, what)
                assert "no answer" not in got[0].text, what


@pytest.mark.parametrize("module", MODULES)
def test_node_answers_odd_values_without_an_end_or_a_motion(
    module: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    started = StartedNode(module, monkeypatch)
    trial = Trial(started)
    try:
        trial.refresh()
        trial.try_topics()
        trial.try_services()
    finally:
        started.close()


def permitted(scan: Scan | None) -> float:
    """The speed ahead (m/s, of 0.45) that the obstacle stop permits after a second of such scans."""
    bus = Bus()
    node, robot = bus.node("mux"), bus.node("robot")
    guards: list[Guard | None] = []
    base = load_base(str(launch_library()), "stage", "")
    ObstacleStop(node, base, guards.append, Writes(node), on=True, sonars=True, lag=0.1)
    odometry, scans = robot.publish("odom", Odometry), robot.publish(base.lidar.topic if base.lidar else "", Scan)
    for _ in range(20):
        odometry.send(Odometry(bus.now, "odom", "base_footprint", Pose2(0.0, 0.0, 0.0), Twist(0.0, 0.0)))
        if scan is not None:
            scans.send(replace(scan, stamp=bus.now))
        bus.run(0.05)
    assert guards[-1] is not None
    return guards[-1].permit(0.45, 0.0, bus.now / 1e9).forward


WALLS = replace(usable_value(Scan, 1, "laser"), ranges=np.full(360, 0.2, np.float32), angle_increment=math.radians(1.0))


@pytest.mark.parametrize("field", [each.name for each in fields(Scan) if each.name not in ("stamp", "frame", "ranges")])
def test_no_field_of_a_scan_makes_the_obstacle_stop_permit_more_than_without_a_scan(field: str) -> None:
    without = permitted(None)
    assert permitted(WALLS) < without < 0.45
    for odd in odd_values(hints_of(Scan)[field], getattr(WALLS, field), field):
        assert permitted(replace(WALLS, **{field: odd})) <= without, f"{field}: {odd}"


def test_ignored_message_is_reported_once_for_each_publisher_with_what_was_expected() -> None:
    bus = Bus()
    got: list[Scan] = []
    bus.node("user").subscribe("scan", Scan, got.append)
    for name in ("lidar", "lidar", "other"):
        bus.node(name).publish("scan", Scan).send(replace(WALLS, range_max=0.0))
        bus.run(0.1)
    lines = [text for _, text in bus.nodes["/user"].lines]
    assert [line.split(";")[0] for line in lines] == [
        f"/scan: message of /{name} ignored: range_min is 0.05 and range_max 0, expected 0 <= range_min < range_max"
        for name in ("lidar", "other")
    ]
    assert not got
