"""The speed that a path permits beside obstacles: a fast robot needs more room than it has width.

What steering is off by grows with the speed, so each m/s needs a third of a metre more between the outline and what is
beside it. Bases that drive at most `FAST` keep the margin of their footprint at any speed.
"""

import math
from dataclasses import replace

import numpy as np
from scipy.ndimage import distance_transform_edt

from ur_nodes.costmap.costmap import LETHAL, Costmap
from ur_nodes.costmap.footprint import Footprint
from ur_nodes.navigation.steering.rollout import ReferencePath
from ur_nodes.navigation.steering.speed_profile import SpeedLimits, brake_for

FAST = 0.6  # m/s
_CAREFUL = 0.5  # m/s: where it only just passes
_MARGIN = 0.05  # m of room that permit no more than that
_PER_METRE = 3.0  # m/s


def slow_beside(
    reference: ReferencePath, index: int, costmap: Costmap, footprint: Footprint, limits: SpeedLimits
) -> ReferencePath:
    """Return the path with lower speeds beside obstacles, from point `index` on as far as the costmap reaches."""
    reach = math.ceil(0.5 * math.hypot(*costmap.shape) * costmap.resolution / reference.spacing)
    part = slice(index, min(index + reach, reference.end + 1))
    if part.stop <= part.start or not (costmap.costs == LETHAL).any():
        return reference
    distances = distance_transform_edt(costmap.costs != LETHAL) * costmap.resolution
    rows, columns = costmap.cells_of_points(reference.points[part]).T
    height, width = costmap.shape
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    room = np.full(len(rows), np.inf)
    room[inside] = distances[rows[inside], columns[inside]] - footprint.inscribed - _MARGIN
    allowed = _CAREFUL + _PER_METRE * np.maximum(0.0, room)
    speeds = reference.speeds.copy()
    speeds[part] = np.minimum(speeds[part], allowed)
    speeds[: part.stop] = brake_for(speeds[: part.stop], reference.spacing, limits)
    return replace(reference, speeds=speeds)
