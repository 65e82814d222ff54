"""Rays of range sensors against the shapes of a MuJoCo model, and ranges after REP 117 from their lengths."""

import mujoco
import numpy as np
import numpy.typing as npt

from ur_nodes.simulator.mujoco_model import LIDAR_GROUPS

Floats = npt.NDArray[np.float64]


class RayCaster:
    """As many rays at once as a sensor has, which hit everything that lidars detect but the robot's own `body`.

    `reach` (m) is how far they go. The arrays are allocated once.
    """

    def __init__(self, model: object, body: int, count: int, reach: float) -> None:
        self._model = model
        self._body = body
        self._reach = reach
        self._groups = np.array(LIDAR_GROUPS, np.uint8)
        self._hit = np.zeros(count, np.int32)
        self._distance = np.zeros(count)

    def cast(self, data: object, point: Floats, directions: Floats) -> Floats:
        """Distances (m), shape (count,), from `point` (3,) along unit vectors (count, 3); negative where nothing is.

        The array is used again by the next call.
        """
        mujoco.mj_multiRay(
            self._model,
            data,
            point,
            directions.ravel(),
            self._groups,
            1,  # walls too
            self._body,
            self._hit,
            self._distance,
            None,
            len(self._distance),
            self._reach,
        )
        return self._distance


def measured_ranges(distances: Floats, noise: Floats, limits: tuple[float, float]) -> Floats:
    """Ranges (m) from distances, which are negative or infinite where nothing is, with `noise` (m) added.

    After REP 117: +inf where nothing is within the upper limit, -inf where something is nearer than the lower one.
    """
    nearest, farthest = limits
    ranges = distances + noise
    missed = (distances < 0.0) | ~np.isfinite(distances) | (ranges > farthest)
    ranges[ranges < nearest] = -np.inf
    ranges[missed] = np.inf
    return ranges
