"""The newest values of a robot's sensors, for other threads than the node's."""

from __future__ import annotations

import math
from typing import TypeVar, cast

import numpy as np

from ur_nodes.client.script.errors import Lost
from ur_nodes.client.script.node_calls import NodeCalls
from ur_nodes.geometry.scan import angles_of_beams, classify_ranges
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Scan

Value = TypeVar("Value")

PATIENCE = 10.0
"""Seconds for which a call waits for what a robot has to send."""

FRESH = 2.0
"""Seconds: the greatest age of a sensor's value."""

FOREVER = 1e9  # s


class SensorValues:
    """Subscribes to topics on first use, and keeps the newest value of each."""

    def __init__(self, calls: NodeCalls) -> None:
        self._calls, self._node = calls, calls.node
        self._values: dict[str, tuple[object, float]] = {}

    def newest(self, topic: str, kind: type[Value], fresh: float, quality: Quality = Quality.NEWEST) -> Value:
        """Return the newest value of a topic, at most `fresh` s old; the first call subscribes. Raises Lost."""
        if topic not in self._values:
            self._values[topic] = (None, -math.inf)
            self._calls.on_node(lambda: self._subscribe(topic, kind, quality))
        if not self._calls.until(lambda: self._node.steady() - self._values[topic][1] <= fresh, PATIENCE):
            raise Lost(f"no {kind.__name__.lower()} on {self._node.resolve(topic)}; does the robot publish it?")
        return cast("Value", self._values[topic][0])

    def _subscribe(self, topic: str, kind: type[Value], quality: Quality) -> None:
        def on_value(value: Value) -> None:
            self._values[topic] = (value, self._node.steady())

        self._node.subscribe(topic, kind, on_value, quality)


def find_nearest(scan: Scan, width: float, direction: float) -> float:
    """Return the shortest range (m) within `width` degrees about `direction` (degrees to the left); inf for none."""
    angles = angles_of_beams(len(scan.ranges), scan.angle_min, scan.angle_increment) - math.radians(direction)
    about = np.abs((angles + math.pi) % (2.0 * math.pi) - math.pi) <= math.radians(width) / 2.0
    hits = classify_ranges(scan.ranges, (scan.range_min, scan.range_max)).hits & about
    return float(scan.ranges[hits].min()) if hits.any() else math.inf
