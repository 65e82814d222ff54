"""Ranges of sonars as rays, so that a costmap can be made of them."""

from __future__ import annotations

import math

import numpy as np

from ur_nodes.navigation.layers import Beams

_STEP = 0.035  # rad between rays: half a cell of 5 cm at 0.7 m, where sonars matter


def beams_of_range(distance: float, field_of_view: float, range_min: float, range_max: float) -> Beams:
    """The cone of a sensor_msgs/Range: the echo may come from anywhere on the arc at `distance`, nothing is nearer.

    `field_of_view` is the full angle, in rad. Beyond `range_max` (or +inf, REP 117) nothing was heard: the cone is
    free. Nearer than `range_min`, and NaN, says nothing: no rays.
    """
    if math.isnan(distance) or distance < range_min:
        return Beams(np.empty(0), np.empty(0), np.empty(0, bool))
    count = max(2, math.ceil(field_of_view / _STEP) + 1)
    angles = np.linspace(-field_of_view / 2.0, field_of_view / 2.0, count)
    heard = distance < range_max
    return Beams(angles, np.full(count, min(distance, range_max)), np.full(count, heard))
