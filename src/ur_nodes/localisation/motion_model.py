"""The odometry motion model of a robot with two driven wheels.

Source: Thrun, Burgard, Fox, Probabilistic Robotics, table 5.6; the two kinds of spread are those of upstream's amcl.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, wrap_angle

OdometryKind = Literal["diff", "diff-corrected"]


@dataclass(frozen=True, slots=True)
class MotionModel:
    """Noise of the odometry: rotation by rotation, by translation, translation by translation, by rotation.

    With "diff-corrected" the alphas scale squares and the deviation is the square root, as in the book; with "diff" the
    sum of squares itself is the deviation, as in upstream's first version and as many parameter files expect.
    """

    kind: OdometryKind
    alpha1: float
    alpha2: float
    alpha3: float
    alpha4: float


@dataclass(frozen=True, slots=True)
class Steps:
    """A movement as turn (rad), drive (m), turn (rad)."""

    turn1: float
    drive: float
    turn2: float


def decompose(before: Pose2, after: Pose2) -> Steps:
    """Decompose the movement between two poses of the odometry. A small movement is a turn only."""
    dx, dy = after.x - before.x, after.y - before.y
    drive = math.hypot(dx, dy)
    turn1 = wrap_angle(math.atan2(dy, dx) - before.yaw) if drive >= 0.01 else 0.0
    return Steps(turn1, drive, wrap_angle(after.yaw - before.yaw - turn1))


def spread_of_steps(steps: Steps, model: MotionModel) -> Steps:
    """Return the standard deviations of the three parts. Driving backwards is one drive, not two half turns."""
    turn1 = min(abs(steps.turn1), abs(wrap_angle(steps.turn1 - math.pi)))
    turn2 = min(abs(steps.turn2), abs(wrap_angle(steps.turn2 - math.pi)))
    drive = steps.drive * steps.drive
    squares = (
        model.alpha1 * turn1 * turn1 + model.alpha2 * drive,
        model.alpha3 * drive + model.alpha4 * (turn1 * turn1 + turn2 * turn2),
        model.alpha1 * turn2 * turn2 + model.alpha2 * drive,
    )
    if model.kind == "diff":
        return Steps(*squares)
    return Steps(*(math.sqrt(value) for value in squares))


def move_poses(
    poses: NDArray[np.float64], before: Pose2, after: Pose2, model: MotionModel, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return poses (n, 3) after the movement of the odometry, each with independent noise."""
    steps = decompose(before, after)
    spread = spread_of_steps(steps, model)
    noise = rng.standard_normal((3, len(poses)))
    turn1 = steps.turn1 + spread.turn1 * noise[0]
    drive = steps.drive + spread.drive * noise[1]
    turn2 = steps.turn2 + spread.turn2 * noise[2]
    heading = poses[:, 2] + turn1
    yaws = wrap_angle(heading + turn2)
    return np.column_stack((poses[:, 0] + drive * np.cos(heading), poses[:, 1] + drive * np.sin(heading), yaws))
