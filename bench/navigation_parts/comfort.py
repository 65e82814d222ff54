"""Comfort of the people round a robot: how near it comes to them, how long it is near, how often it freezes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.hull import Hull
from ur_nodes.ports.values import Odometry, Poses
from ur_nodes.simulator.mujoco_model import PERSON_RADIUS

NEAR = 0.5
"""Room to a person, m: less is near."""

FREEZE = 3.0
"""Rest during a goal, s: longer is a freeze."""

_MOVING, _TURNING = 0.02, 0.1  # m/s, rad/s


@dataclass(frozen=True, slots=True)
class Comfort:
    """Figures of some drives. `closest` is the least room (m) while the robot moves, `near` the seconds below NEAR."""

    closest: float
    near: float
    seconds: float
    freezes: int
    strikes: int


def judge_comfort(hull: Hull, truths: Sequence[Odometry], people: Sequence[Poses], strikes: int) -> Comfort:
    """Compare the robot's true poses with the places of people at the same stamps, during goals."""
    places = {each.stamp: each.poses[:, :2] for each in people}
    closest, near, rest, freezes, last = np.inf, 0.0, 0.0, 0, None
    begin = end = truths[0].stamp if truths else 0
    for truth in truths:
        seconds = 0.0 if last is None else min((truth.stamp - last) * 1e-9, 0.1)
        last = end = truth.stamp
        moving = abs(truth.twist.forward) > _MOVING or abs(truth.twist.turn) > _TURNING
        before, rest = rest, 0.0 if moving else rest + seconds
        freezes += before < FREEZE <= rest
        if not moving or truth.stamp not in places:
            continue
        gaps = hull.distances(truth.pose.inverse().transform_points(places[truth.stamp])) - PERSON_RADIUS
        closest = min(closest, float(gaps.min(initial=np.inf)))
        near += seconds if gaps.min(initial=np.inf) < NEAR else 0.0
    return Comfort(closest, near, (end - begin) * 1e-9, freezes, strikes)
