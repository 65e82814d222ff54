"""Turns at the ends of a path that are made while the robot drives: bends in place of turns on the spot."""

import math

import numpy as np
from scipy.spatial import cKDTree

from ur_nodes.costmap.costmap import LETHAL, Costmap
from ur_nodes.geometry.pose import wrap_angle
from ur_nodes.navigation.planning.path_geometry import Points, arc_lengths
from ur_nodes.navigation.planning.path_smooth import Weights

_LEAST_TURN, _MOST_TURN = 0.3, 1.6  # rad: smaller turns are left as they are, no bend is longer
_STEP = 0.1  # rad between bends that are tried
_REACHES = (0.4, 0.7, 1.0, 1.4, 1.9, 2.5)  # m of the path that a bend and the line to it replace
_TIGHTEST, _BRAKING = 0.6, 0.2  # share of the radius at the end itself, m before it from which it shrinks
_KINK = 0.3  # rad between the path and that line
_LENGTH = 1.2  # what a metre of the way costs against the turn that a robot makes meanwhile
_SAMPLE = 0.05  # m


def blend_turns(
    path: Points, yaw: float, heading: float | None, bend: float, room: float, costmap: Costmap, weights: Weights
) -> Points:
    """Return a path (n, 2) that leaves nearer to `yaw` and arrives nearer to `heading` (rad), where that saves time.

    `bend` (m) is the radius of a turn at full speed. Bends keep `room` (m) to obstacles, as turns on the spot need it;
    there are none at an end with less. Points are not evenly spaced.
    """
    backwards = _blend_end(path[::-1], wrap_angle(yaw + math.pi), bend, room, costmap, weights)
    return backwards[::-1] if heading is None else _blend_end(backwards[::-1], heading, bend, room, costmap, weights)


def _blend_end(path: Points, heading: float, bend: float, room: float, costmap: Costmap, weights: Weights) -> Points:
    along = arc_lengths(path)
    last = path[-1] - path[max(0, len(path) - 4)]
    turn = wrap_angle(heading - math.atan2(last[1], last[0]))
    if abs(turn) < _LEAST_TURN:
        return path
    walls = _walls_near(path[-1], costmap)
    if walls.query(path[-1])[0] < room:
        return path
    best, least = path, 0.0
    sizes = np.arange(_STEP, min(abs(turn), _MOST_TURN) + 0.5, _STEP).tolist()
    bends = [(size, _bend(size, bend) * (1.0, math.copysign(1.0, turn))) for size in sizes]
    for reach in (each for each in _REACHES if each < along[-1] - 0.3 or each == _REACHES[0]):
        index = max(0, int(np.searchsorted(along, along[-1] - reach)) - 1)
        before = path[index] - path[max(0, index - 3)]
        saved = _cost(path[index:], abs(turn), bend, costmap, weights)
        for size, arc in bends:
            piece = _joined(path[index], path[-1], arc)
            if piece is None:
                continue
            line = piece[1] - piece[0]
            course = math.atan2(line[1], line[0])
            if index and abs(wrap_angle(course - math.atan2(before[1], before[0]))) > _KINK:
                continue
            left = abs(wrap_angle(heading - course - math.copysign(size, turn)))
            cost = _cost(piece, left, bend, costmap, weights) - saved
            if cost < least and walls.query(piece[-len(arc) :])[0].min() >= room - 1e-9:
                best, least = np.vstack((path[:index], piece)), cost
    return best


def _walls_near(place: Points, costmap: Costmap) -> cKDTree:
    """Return the obstacles within the reach of a bend from a place, and something far away."""
    row, column = costmap.cells_of_points(place).tolist()
    reach = math.ceil(_REACHES[-1] / costmap.resolution)
    corner = np.array((max(0, row - reach), max(0, column - reach)))
    part = costmap.costs[corner[0] : row + reach + 1, corner[1] : column + reach + 1]
    walls = costmap.points_of_cells(np.argwhere(part == LETHAL) + corner)
    return cKDTree(np.vstack((walls, place + 1e3)))


def _bend(size: float, bend: float) -> Points:
    """Return the points of a bend to the left by `size` (rad) that begins at the origin along x."""
    turned, course, places = 0.0, size, [(0.0, 0.0)]
    while course > 0.0:  # back from its end, where the robot brakes and can turn more sharply
        radius = bend * min(1.0, _TIGHTEST + (1.0 - _TIGHTEST) * turned / _BRAKING)
        middle = max(course - 0.5 * 0.02 / radius, 0.0)
        step = min(0.02, course * radius)
        x, y = places[-1]
        places.append((x - step * math.cos(middle), y - step * math.sin(middle)))
        course, turned = course - step / radius - 1e-9, turned + step
    points: Points = np.array(places[::-1])
    points -= points[0]
    return points


def _joined(start: Points, end: Points, arc: Points) -> Points | None:
    """Return a line from `start` and the arc after it, turned so that they arrive at `end`; None if they do not fit."""
    distance, aside = math.dist(start, end), float(arc[-1, 1])
    if distance <= abs(aside) or math.sqrt(distance**2 - aside**2) < arc[-1, 0] + 0.02:
        return None
    length = math.sqrt(distance**2 - aside**2) - arc[-1, 0]
    ahead = end - start
    course = math.atan2(ahead[1], ahead[0]) - math.asin(aside / distance)
    c, s = math.cos(course), math.sin(course)
    line = np.stack((np.arange(0.0, length, _SAMPLE), np.zeros(math.ceil(length / _SAMPLE))), axis=-1)
    whole = np.vstack((line, arc + np.array((length, 0.0))))
    turned: Points = whole @ np.array(((c, s), (-s, c))) + start
    return turned


def _cost(points: Points, turn: float, bend: float, costmap: Costmap, weights: Weights) -> float:
    """The time of a piece and the turn (rad) after it, in that in which the robot turns by a radian."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    return _LENGTH * float(weights[costmap.costs_at(points[1:])] @ steps) / bend + turn
