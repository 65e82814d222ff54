"""Distances of sonars as messages."""

import math

from ur.robot.base import Sonars
from ur_nodes.ports.values import Range


def make_range(sonars: Sonars, frame: str, distance: float, stamp: int) -> Range:
    """A distance (m) as REP 117 has it: +inf for nothing within `range_max`, -inf for nearer than `range_min`."""
    if distance > sonars.range_max:
        distance = math.inf
    elif distance < sonars.range_min:
        distance = -math.inf
    return Range(stamp, frame, distance, sonars.field_of_view, sonars.range_min, sonars.range_max)
