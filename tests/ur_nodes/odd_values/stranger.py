"""A program that sends odd values to a node of either ROS: stranger.py TRIAL, which is JSON with what the node has.

`topics` and `services` are names with kinds, `outputs` topics with velocities. It prints one line of JSON: the numbers
of values that were sent and that no message can have, of answers, and the velocities other than zero that arrived.
"""

import json
import sys
import threading
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any

from tests.ur_nodes.odd_values.generator import odd_values, usable_value

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.actions import Goal
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.validation import problem_of
from ur_nodes.ports.values import StampedPose, Transform
from ur_nodes.run import attach

PERIOD = 0.004  # s
MOUNTED = ("laser", "base_link", "imu", "sonar", "camera")
FRAMES = {"Scan": "laser", "Imu": "imu", "Range": "sonar", "Odometry": "odom", "tuple": "odom"}
LEAST = 25
SLOWEST = 1e-4  # m/s, rad/s: less is rounding


def usable(kind: Any, now: int) -> Any:
    """A value of a kind in the frame of its sensor."""
    return usable_value(kind, now, FRAMES.get(kind.__name__, "map"))


def oddities(kind: Any, value: Any) -> list[Any]:
    """The odd values that differ from a usable one; LEAST of them or more, repeated where its kind has fewer."""
    found = list(odd_values(kind, value)) or [value]
    return found * -(-LEAST // len(found))


def send_frames(node: Node) -> None:
    """Send where the robot is, which turns by a small angle at a time."""
    yaw = (node.now() / 1e9) % 6.0 - 3.0
    node.transforms.send(
        Transform(node.now(), "map", "odom", Pose2(0.0, 0.0, 0.0).in_space()),
        Transform(node.now(), "odom", "base_footprint", Pose2(0.0, 0.0, yaw).in_space()),
    )


def mount_sensors(node: Node) -> None:
    """Send the fixed frames of a robot's sensors."""
    pose = Pose2(0.1, 0.0, 0.0).in_space()
    node.transforms.send(*(Transform(node.now(), "base_footprint", each, pose, fixed=True) for each in MOUNTED))


class Stranger:
    """Sends all, one value at a time; calls `end` when the last has had time to arrive."""

    def __init__(self, node: Node, trial: dict[str, Any], end: Callable[[], None]) -> None:
        self._node, self._end = node, end
        self._topics = [(name, _kind_of(kind)) for name, kind in trial["topics"]]
        self._services = [(name, _kind_of(kind)) for name, kind in trial["services"]]
        self._publishers: dict[str, Any] = {}
        self.report: dict[str, Any] = {"sent": 0, "impossible": 0, "answers": 0, "moved": []}
        for name, kind in self._topics:
            self._offer(name, kind)
        for name, kind in trial["outputs"]:
            node.subscribe(name, _kind_of(kind), self._note, Quality.EVERY)
        mount_sensors(node)
        self._steps = self._attack()
        node.every(0.05, lambda: send_frames(node))
        node.after(1.5, self._begin, steady=True)

    def _offer(self, name: str, kind: Any) -> None:
        try:
            self._publishers[name] = self._node.publish(name, kind, Quality.LATCHED)
        except KeyError:
            self.report["impossible"] += 1  # goals are no messages of ROS 1 themselves

    def _begin(self) -> None:
        self._node.every(PERIOD, self._step, steady=True)

    def _step(self) -> None:
        if next(self._steps, "end") == "end":
            self._node.after(2.0, self._end, steady=True)

    def _attack(self) -> Iterator[None]:
        for name, kind in self._topics:
            for index, value in enumerate(oddities(kind, usable(kind, self._node.now()))):
                if index % 10 == 0:
                    self._refresh()
                if not isinstance(value, (Goal, StampedPose)) or problem_of(getattr(value, "target", value)):
                    self._send(name, value)  # a goal that is usable is driven to
                yield
        for name, kind in self._services:
            for value in oddities(kind, usable(kind, self._node.now())):
                try:
                    self._node.call(name, value, self._count)
                except Exception:  # no message can have the value
                    self.report["impossible"] += 1
                yield

    def _refresh(self) -> None:
        for name, kind in self._topics:
            if kind not in (Goal, StampedPose):
                self._send(name, usable(kind, self._node.now()))

    def _send(self, name: str, value: Any) -> None:
        try:
            self._publishers[name].send(value)
            self.report["sent"] += 1
        except Exception:  # no message can have the value
            self.report["impossible"] += 1

    def _count(self, _answer: object) -> None:
        self.report["answers"] += 1

    def _note(self, value: Any) -> None:
        twist = getattr(value, "twist", value)
        if max(abs(twist.forward), abs(twist.turn), abs(twist.left)) > SLOWEST:
            self.report["moved"].append(str(twist))


def _kind_of(name: str) -> Any:
    module, _, own = name.rpartition(".")
    return getattr(import_module(module), own)


def main() -> None:
    done = threading.Event()
    with attach("stranger", lambda node: Stranger(node, json.loads(sys.argv[1]), done.set), done.set) as (wired, _node):
        done.wait()
    sys.stdout.write(json.dumps(wired.report) + "\n")


if __name__ == "__main__":
    main()
