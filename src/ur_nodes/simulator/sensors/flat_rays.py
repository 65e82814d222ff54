"""Rays of range sensors: in space, and faster in a plane for level lidars, where all that they can hit is upright."""

import math
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from ur.robot.base import Lidar
from ur_nodes.geometry.hull import hull_of_outline
from ur_nodes.simulator.mujoco_model import LIDAR_GROUPS

Floats = npt.NDArray[np.float64]


def cast_rays(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    point: Floats,
    directions: Floats,
    body: int,
    reach: float,
    groups: tuple[int, ...] = LIDAR_GROUPS,
) -> Floats:
    """Distances (m), shape (count,), from `point` (3,) along unit vectors (count, 3); negative where nothing is.

    The rays hit everything that lidars detect but the robot's own `body`; `reach` (m) is how far they go.
    """
    count, walls, seen = len(directions), 1, np.array(groups, np.uint8)
    hit, distances = np.zeros(count, np.int32), np.zeros(count)
    mujoco.mj_multiRay(model, data, point, directions.ravel(), seen, walls, body, hit, distances, None, count, reach)
    return distances


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


_LEVEL = math.cos(0.03)  # a robot that brakes is less than this (rad) from level: 0.05 % of a range
_ROOM = 0.02  # m from the rays to the top and the bottom of shapes
_EVEN = 1e-3  # m: corners of a top
_SLACK = 1e-9  # of the step between two beams: a beam through a corner meets the sides of both
_PARALLEL = 1e-12
_CELL = 0.5  # m: which walls can be seen is found once for each square of this size
_MOST_CELLS = 4000
_WORTH = 16  # scans from a square: finding it takes what as many of them save
_MOST_SCREENS = 64  # sides that may hide others: the nearest
_MARGIN = 1e-6  # m, m^2
_QUARTERS = np.array(((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)))
_NO_SIDES: Floats = np.zeros((4, 0))


class UprightShapes:
    """The sides of all that lidars detect but `without` a body, seen from above, at a height (m) above the floor.

    `flat` is false where something is no upright prism, or begins or ends near that height.
    """

    def __init__(self, model: mujoco.MjModel, height: float, without: int = -1) -> None:
        self.flat = True
        self._height = height
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        fixed, moving, bodies = [_NO_SIDES], [_NO_SIDES], []
        for geom in range(model.ngeom):
            if not LIDAR_GROUPS[model.geom_group[geom]]:
                continue
            body = int(model.geom_bodyid[geom])
            prism = _prism_of(model, data, geom)
            if prism is None or min(abs(prism.low - height), abs(prism.high - height)) < _ROOM:
                self.flat = False
            elif prism.low < height < prism.high and model.body_weldid[body] == 0:
                fixed.append(_sides_of(prism.corners))
            elif prism.low < height < prism.high and body != without:
                turn, place = data.xmat[body].reshape(3, 3)[:2, :2], data.xpos[body, :2]
                moving.append(_sides_of((prism.corners - place) @ turn))
                bodies += [body] * moving[-1].shape[1]
        self._fixed, self._moving = np.concatenate(fixed, axis=1), np.concatenate(moving, axis=1)
        self._bodies = np.array(bodies, np.int64)
        self._heights = data.xpos[self._bodies, 2]
        self._movers, self._poses = np.unique(self._bodies), b"none yet"
        self._seen_by: dict[int, Floats | None] = {}  # the moving sides now, by own bodies
        self._seen: dict[tuple[int, int], Floats] = {}
        self._asked: dict[tuple[int, int], int] = {}

    def sides(self, data: mujoco.MjData, own_body: int, point: tuple[float, float]) -> tuple[Floats, Floats] | None:
        """The sides now that may be seen from a point, but those of a body: fixed and moving ones, shapes (4, n).

        They are x, y of a corner, and dx, dy on, counter-clockwise. None: a shape has tipped over, or is higher or
        lower than at first. The moving ones are the same array until something moves.
        """
        poses = data.xpos[self._movers].tobytes() + data.xmat[self._movers].tobytes()
        if poses != self._poses:  # the same for all lidars at a time
            self._poses = poses
            turn, place = data.xmat[self._bodies], data.xpos[self._bodies]
            self._upright = (turn[:, 8] >= _LEVEL) & (np.abs(place[:, 2] - self._heights) <= _ROOM / 2.0)
            (x, y, dx, dy), (a, b), (c, d) = self._moving, turn[:, :2].T, turn[:, 3:5].T
            now = (place[:, 0] + a * x + b * y, place[:, 1] + c * x + d * y, a * dx + b * dy, c * dx + d * dy)
            self._now = np.stack(now)
            self._seen_by.clear()
        moving = self._seen_by.get(own_body)
        if moving is None:
            others = self._bodies != own_body
            moving = self._seen_by[own_body] = self._now[:, others] if self._upright[others].all() else None
        cell = math.floor(point[0] / _CELL), math.floor(point[1] / _CELL)
        asked = self._asked[cell] = self._asked.get(cell, 0) + 1
        fixed = self._seen.get(cell) if asked > _WORTH else self._fixed
        if fixed is None:
            if len(self._seen) >= _MOST_CELLS:
                self._seen.clear()
                self._asked.clear()
            middle = (cell[0] + 0.5) * _CELL, (cell[1] + 0.5) * _CELL
            fixed = self._seen[cell] = self._fixed[:, find_visible(self._fixed, middle, _CELL / 2.0 + _MARGIN)]
        return None if moving is None else (fixed, moving)

    def is_at_height(self, point: Floats, turn: Floats) -> bool:
        """Return whether a lidar with a place (3,) and a rotation matrix (9,) sees in the plane of the sides."""
        return bool(turn[8] >= _LEVEL and abs(point[2] - self._height) < _ROOM / 2.0)


def find_visible(sides: Floats, middle: tuple[float, float], half: float) -> npt.NDArray[np.int64]:
    """Number the sides, shape (4, n), that a point of a square may see; `half` is half the length of its edges, m.

    A side is left out where no point of the square is in front of it, or one side hides it from all of them: every
    line from a corner to one of its ends, and so all between them, passes through the inside of that side.
    """
    x, y, dx, dy = sides
    corners = [(middle[0] + i * half, middle[1] + j * half) for i in (-1, 1) for j in (-1, 1)]
    away = np.stack([(y - cy) * dx - (x - cx) * dy for cx, cy in corners])
    in_front = np.flatnonzero(away.min(axis=0) > _MARGIN)
    nearest = np.argsort(np.hypot(x + dx / 2.0 - middle[0], y + dy / 2.0 - middle[1])[in_front])[:_MOST_SCREENS]
    left, top, along, up = sides[:, in_front[nearest], None]
    hidden = np.ones((len(left), len(x)), np.bool_)
    for end_x, end_y in ((x, y), (x + dx, y + dy)):
        hidden &= (top - end_y) * along - (left - end_x) * up < -_MARGIN
        for cx, cy in corners:
            to_x, to_y = end_x - cx, end_y - cy
            hidden &= to_x * (top - cy) - to_y * (left - cx) > _MARGIN
            hidden &= to_x * (top + up - cy) - to_y * (left + along - cx) < -_MARGIN
    return np.flatnonzero((away.max(axis=0) > -_MARGIN) & ~hidden.any(axis=0))


class PlanarBeams:
    """Beams in a plane: `count` of them from the angle `first` (rad) on, `step` apart, counter-clockwise."""

    def __init__(self, first: float, step: float, count: int, reach: float) -> None:
        """`reach` (m) is how far they go."""
        self._first, self._step, self._reach = first, step, reach
        self.angles = first + step * np.arange(count)
        self._pose: tuple[float, ...] = ()

    def cast(self, fixed: Floats, moving: Floats, point: tuple[float, float], yaw: float) -> Floats:
        """Distances (m), shape (count,), from a place to the nearest of the sides; inf where nothing is in reach.

        From the same place only what has moved is looked at again. The array is not to be changed.
        """
        if self._pose != (*point, yaw):
            self._pose, self._moving, self._to_fixed = (*point, yaw), moving, None
            self._distances = self._cast(np.concatenate((fixed, moving), axis=1))
        elif moving is not self._moving:
            if self._to_fixed is None:
                self._to_fixed = self._cast(fixed)
            self._moving, self._distances = moving, np.minimum(self._to_fixed, self._cast(moving))
        return self._distances

    def _cast(self, sides: Floats) -> Floats:
        (x, y, dx, dy), point, yaw = sides, self._pose[:2], self._pose[2]
        x, y = x - point[0], y - point[1]
        away = y * dx - x * dy  # to the line of the side, times its length
        facing = away > 0.0
        x, y, dx, dy, away = x[facing], y[facing], dx[facing], dy[facing], away[facing]
        end_x, end_y = x + dx, y + dy
        # The beams that meet a side, as numbers: from its end, counter-clockwise, to its corner.
        start = (np.arctan2(end_y, end_x) - (self._first + yaw)) / self._step
        turn = 2.0 * math.pi / self._step
        start -= turn * np.floor(start / turn)
        end = start + np.arctan2(away, x * end_x + y * end_y) / self._step
        which = np.flatnonzero(end >= turn)  # they begin before the first beam, and end after it
        both = np.concatenate((np.arange(len(start)), which))
        first = np.ceil(np.concatenate((start, start[which] - turn)) - _SLACK).astype(np.int64)
        last = np.floor(np.concatenate((end, end[which] - turn)) + _SLACK).astype(np.int64)
        np.maximum(first, 0, out=first)
        np.minimum(last, len(self.angles) - 1, out=last)
        counts = np.maximum(last - first + 1, 0)
        ends = np.cumsum(counts)
        beams = np.arange(int(ends[-1]) if len(ends) else 0) + np.repeat(first - (ends - counts), counts)
        side = np.repeat(both, counts)
        angles = self.angles + yaw
        slope = np.sin(angles)[beams] * dx[side] - np.cos(angles)[beams] * dy[side]
        distances = np.full(len(angles), np.inf)
        np.minimum.at(distances, beams, away[side] / np.maximum(slope, _PARALLEL))
        distances[distances > self._reach] = np.inf
        return distances


@dataclass(frozen=True, slots=True)
class _Prism:
    """An upright prism: its corners seen from above, counter-clockwise, shape (n, 2), and where it begins and ends."""

    corners: Floats
    low: float
    high: float


def _prism_of(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> _Prism | None:
    """A box or a mesh where it is now; None: it is something else, or not upright."""
    turn, (x, y, z) = data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom].tolist()
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_BOX and turn[2, 2] > 1.0 - 1e-9:
        half = model.geom_size[geom]
        return _Prism(_QUARTERS * half[:2] @ turn[:2, :2].T + (x, y), z - float(half[2]), z + float(half[2]))
    if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH:
        return None
    mesh = int(model.geom_dataid[geom])
    first = int(model.mesh_vertadr[mesh])
    points = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])] @ turn.T + (x, y, z)
    low, high = float(points[:, 2].min()), float(points[:, 2].max())
    above, below = points[points[:, 2] > high - _EVEN, :2], points[points[:, 2] < low + _EVEN, :2]
    if not len(above) == len(below) == len(points) / 2:
        return None
    if not all(np.abs(below - each).max(axis=1).min() < _EVEN for each in above):  # the same in any order
        return None
    return _Prism(hull_of_outline([(px, py) for px, py in above.tolist()]).corners, low, high)


def _sides_of(corners: Floats) -> Floats:
    """The sides of a polygon: see UprightShapes.sides."""
    x, y = corners.T
    return np.stack((x, y, np.roll(x, -1) - x, np.roll(y, -1) - y))


class LidarBeams:
    """The beams of one lidar, in the order of a LaserScan: from `angle_min` to `angle_max`, counter-clockwise.

    They are cast in the plane of `shapes` where that is the same, else in space.
    """

    def __init__(self, model: mujoco.MjModel, lidar: Lidar, robot: int, shapes: UprightShapes | None = None) -> None:
        self._model, self._lidar = model, lidar
        self._shapes = shapes if shapes and shapes.flat else None
        self._site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, f"lidar_{robot}")
        self._body = int(model.site_bodyid[self._site])
        self._reach = lidar.range_max + 6.0 * lidar.noise
        step = (lidar.angle_max - lidar.angle_min) / (lidar.samples - 1)
        self._every = PlanarBeams(lidar.angle_min, step, lidar.samples, self._reach)

    def cast(self, data: mujoco.MjData, noise: Floats) -> Floats:
        """Ranges (m), shape (samples,), with `noise` (standard normal, same shape) scaled to the lidar's.

        After REP 117: +inf where nothing is within `range_max`, -inf where something is nearer than `range_min`.
        """
        return self.measured(self._cast(data, self._every), noise)

    def cast_some(self, data: mujoco.MjData, first: float, step: float, count: int) -> Floats:
        """Distances (m), shape (count,), along other beams: from an angle (rad) on, a step (rad) apart."""
        return self._cast(data, PlanarBeams(first, step, count, self._reach))

    def measured(self, distances: Floats, noise: Floats) -> Floats:
        """The ranges of distances, as of `cast`."""
        lidar = self._lidar
        return measured_ranges(distances, lidar.noise * noise, (lidar.range_min, lidar.range_max))

    def _cast(self, data: mujoco.MjData, beams: PlanarBeams) -> Floats:
        place, turn = data.site_xpos[self._site], data.site_xmat[self._site]
        if self._shapes and self._shapes.is_at_height(place, turn):
            point = float(place[0]), float(place[1])
            if sides := self._shapes.sides(data, self._body, point):
                return beams.cast(*sides, point, math.atan2(turn[3], turn[0]))
        level = np.stack([np.cos(beams.angles), np.sin(beams.angles), np.zeros(len(beams.angles))], axis=1)
        return cast_rays(self._model, data, place, level @ turn.reshape(3, 3).T, self._body, self._reach)


def make_lidars(model: mujoco.MjModel, lidar: Lidar, robots: int) -> list[LidarBeams]:
    """The lidars of robots, by number."""
    alone = int(model.site_bodyid[mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, "lidar_0")]) if robots == 1 else -1
    shapes = UprightShapes(model, lidar.pose[2], alone)  # no lidar sees a robot that is alone
    return [LidarBeams(model, lidar, robot, shapes) for robot in range(robots)]
