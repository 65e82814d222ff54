"""Marks of what the robot has touched, or its sonars detect, and its lidar does not see; time alone ends none.

A mark is forgotten when its place has been seen free from outside: at once if the lidar has seen something there
before, else for a minute, as it sees through glass and over low boxes always.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.layers import Beams
from ur_nodes.geometry.hull import hull_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.parameters import Parameters

Floats = NDArray[np.float64]

_OUT = 0.03  # m outside of the outline: a mark is no part of the robot
_PUSHES = 0.5  # of the hardest push: what the motion presses less is not touched
_FREE, _FREE_AGAIN = 60.0, 1.0  # s in view until a mark is forgotten, and one where something was seen
_AWAY, _NEAR = 0.3, 3.0  # m from the robot's outline, and from the sensor: a view from outside
_SLACK = 0.12  # m between the end of a beam and a mark
_GAP = 0.05  # rad between a beam and a mark
_SAME = 0.04  # m between marks
_DEPTH = 0.15  # m ahead by which a wider mark goes on: else the robot turns round its end into what it has touched


@dataclass(frozen=True, slots=True)
class BumperSource:
    """The topic of a switch, and the part of the outline that it covers: directions from and to, rad."""

    topic: str
    start: float = -math.pi
    end: float = math.pi


def read_bumpers(layer: Parameters) -> tuple[BumperSource, ...]:
    """Read `topics` (std_msgs/Bool) and `sectors`, one for each, of a costmap's `bumper_layer`. Raises UserError."""
    topics, sectors = layer.texts("topics", ()), layer.points("sectors", ())
    if len(topics) != len(sectors):
        layer.fail("sectors", sectors, f"the directions from and to of each of the {len(topics)} topics")
    return tuple(BumperSource(topic, *sector) for topic, sector in zip(topics, sectors, strict=True))


def touched_points(
    outline: Floats, velocity: tuple[float, float, float], bumper: BumperSource | None = None, widen: float = 0.0
) -> Floats:
    """Return where a robot touches something: points (n, 2) just outside of its outline (m, 2), in its frame.

    They are those of a bumper that the motion presses; without a `bumper`, of the whole outline. `velocity` is that
    ahead, in turns and to the left. To both sides of them are as many more, up to `widen` m away.
    """
    hull, (ahead, turn, left) = hull_of_outline([(x, y) for x, y in outline.tolist()]), velocity
    points = hull.edge_points(bumper.start, bumper.end) if bumper else hull.edge_points(-math.pi, math.pi)
    normals = hull.normals[(points @ hull.normals.T - hull.offsets).argmax(axis=1)]
    pushes = ((ahead - turn * points[:, 1]) * normals[:, 0]) + ((left + turn * points[:, 0]) * normals[:, 1])
    pressed = pushes > _PUSHES * pushes.max(initial=0.0)
    if pressed.any():
        points, normals = points[pressed], normals[pressed]
    push = normals.mean(axis=0)
    across = np.array((-push[1], push[0])) / max(float(np.hypot(*push)), 1e-9)
    offsets = np.arange(-widen, widen + _SAME / 2.0, _SAME)
    ahead = np.arange(0.0, _DEPTH if widen else _SAME, _SAME)[:, None, None, None] * np.array((across[1], -across[0]))
    wide: Floats = (points + _OUT * normals + offsets[:, None, None] * across + ahead).reshape(-1, 2)
    wide = wide[hull.distances(wide) > _OUT / 2.0]
    return wide[np.unique((wide / _SAME).round(), axis=0, return_index=True)[1]]


class TouchMarks:
    """Marked `points` (n, 2), in a frame that does not move."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget all."""
        self.points: Floats = np.empty((0, 2))
        self._seen = np.empty(0)  # s for which each was seen free
        self._limits = np.empty(0)  # s after which each is forgotten

    def add(self, points: Floats) -> None:
        """Mark points (n, 2)."""
        if len(self.points):
            gaps = np.hypot(*np.moveaxis(points[:, None] - self.points, -1, 0))
            self._seen[(gaps < _SAME).any(axis=0)] = 0.0
            points = points[(gaps >= _SAME / 2.0).all(axis=1)]
        self.points = np.concatenate((self.points, points))
        self._seen = np.append(self._seen, np.zeros(len(points)))
        self._limits = np.append(self._limits, np.full(len(points), _FREE))

    def look(self, robot: Pose2, radius: float, sensor: Pose2, beams: Beams, seconds: float) -> bool:
        """Take rays from a sensor that were measured over so long; return whether marks are forgotten.

        Poses are in the frame of the marks; `radius` (m) holds the whole robot.
        """
        if not len(self.points) or not len(beams.angles):
            return False
        local = sensor.inverse().transform_points(self.points)
        away, bearings = np.hypot(*local.T), np.arctan2(local[:, 1], local[:, 0])
        turns = np.abs((beams.angles - bearings[:, None] + math.pi) % math.tau - math.pi)
        nearest = turns.argmin(axis=1)
        measured = turns.min(axis=1) < _GAP
        ranges = beams.ranges[nearest]
        self._limits[measured & beams.hits[nearest] & (np.abs(ranges - away) < _SLACK)] = _FREE_AGAIN
        outside = (np.hypot(*(self.points - robot[:2]).T) > radius + _AWAY) & (away < _NEAR)
        self._seen[measured & outside & (ranges > away + _SLACK)] += seconds
        kept = self._seen < self._limits
        self.points, self._seen, self._limits = self.points[kept], self._seen[kept], self._limits[kept]
        return not kept.all()
