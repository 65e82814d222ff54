"""Ranges of sonars as rays, so that a costmap can be made of them."""

import math

import numpy as np

from ur_nodes.costmap.costmap import FREE, LETHAL, Costmap
from ur_nodes.costmap.layers import Beams
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import classify_ranges

_SLACK, _TURN = 0.25, 0.15  # m, rad by which a wall of the map may seem to be elsewhere
_STEP = 0.035  # rad between rays: half a cell of 5 cm at 0.7 m, where sonars matter


def beams_of_range(distance: float, field_of_view: float, range_min: float, range_max: float) -> Beams:
    """The cone of a sensor_msgs/Range: the echo may come from anywhere on the arc at `distance`, nothing is nearer.

    `field_of_view` is the full angle, in rad. A clear range frees the cone; one that says nothing has no rays.
    """
    returns = classify_ranges(np.array([distance]), (range_min, range_max))
    if not (returns.hits | returns.clear)[0]:
        return Beams(np.empty(0), np.empty(0), np.empty(0, bool))
    count = max(2, math.ceil(field_of_view / _STEP) + 1)
    angles = np.linspace(-field_of_view / 2.0, field_of_view / 2.0, count)
    return Beams(angles, np.full(count, min(distance, range_max)), np.full(count, returns.hits[0]))


def without_walls(beams: Beams, sensor: Pose2, known: Costmap) -> Beams:
    """The cone of a sonar at a pose in the map, free where the map has a wall that may have made the echo.

    An arc is wide, and the robot's pose is not exact: without this the frames of a door would close
    it. `known` has the walls as obstacles.
    """
    if not beams.hits.any():
        return beams
    angles = np.linspace(beams.angles[0] - _TURN, beams.angles[-1] + _TURN, len(beams.angles) + 8) + sensor.yaw
    ranges = beams.ranges[0] + np.arange(-_SLACK, _SLACK + known.resolution / 2.0, known.resolution)
    directions = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    places = (sensor.x, sensor.y) + np.maximum(ranges, 0.0)[:, None, None] * directions
    explained = bool((known.costs_at(places, outside=FREE) == LETHAL).any())
    return Beams(beams.angles, beams.ranges, np.zeros_like(beams.hits)) if explained else beams
