"""The odometry motion models of a robot with two driven wheels, and of one whose wheels roll to all sides.

Source: Thrun, Burgard, Fox, Probabilistic Robotics, table 5.6; the kinds of spread, and the model of a robot that
drives sideways, are those of upstream's amcl: a movement is a translation along a bearing, a strafe across it, and a
turn.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, wrap_angle

OdometryKind = Literal["diff", "diff-corrected", "omni", "omni-corrected"]


@dataclass(frozen=True, slots=True)
class MotionModel:
    """Noise of the odometry: rotation by rotation, by translation, translation by translation, by rotation.

    For a kind that begins with "omni", alpha1 is the noise of translation by rotation and alpha4 that of rotation by
    rotation, as upstream has it; alpha5, which the others do not use, is that of the strafe by translation.
    With "-corrected" the alphas scale squares and the deviation is the square root, as in the book; without it the sum
    of squares itself is the deviation, as in upstream's first version and as many parameter files expect.
    """

    kind: OdometryKind
    alpha1: float
    alpha2: float
    alpha3: float
    alpha4: float
    alpha5: float = 0.0


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
    return Steps(*_deviations(squares, model))


def move_poses(
    poses: NDArray[np.float64], before: Pose2, after: Pose2, model: MotionModel, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return poses (n, 3) after the movement of the odometry, each with independent noise."""
    noise = rng.standard_normal((3, len(poses)))
    if model.kind.startswith("omni"):
        return _move_sideways(poses, before.inverse().compose(after), model, noise)
    steps = decompose(before, after)
    spread = spread_of_steps(steps, model)
    turn1 = steps.turn1 + spread.turn1 * noise[0]
    drive = steps.drive + spread.drive * noise[1]
    turn2 = steps.turn2 + spread.turn2 * noise[2]
    heading = poses[:, 2] + turn1
    yaws = wrap_angle(heading + turn2)
    return np.column_stack((poses[:, 0] + drive * np.cos(heading), poses[:, 1] + drive * np.sin(heading), yaws))


def _move_sideways(
    poses: NDArray[np.float64], movement: Pose2, model: MotionModel, noise: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Move poses along the bearing of a movement, across it by noise alone, and turn them."""
    distance = math.hypot(movement.x, movement.y)
    squared, turned = distance * distance, movement.yaw * movement.yaw
    squares = (
        model.alpha3 * squared + model.alpha1 * turned,
        model.alpha5 * squared + model.alpha1 * turned,
        model.alpha4 * turned + model.alpha2 * squared,
    )
    along, across, turn = _deviations(squares, model)
    heading = poses[:, 2] + math.atan2(movement.y, movement.x)
    c, s = np.cos(heading), np.sin(heading)
    drive, strafe = distance + along * noise[0], across * noise[1]
    yaws = wrap_angle(poses[:, 2] + movement.yaw + turn * noise[2])
    return np.column_stack((poses[:, 0] + drive * c - strafe * s, poses[:, 1] + drive * s + strafe * c, yaws))


def _deviations(squares: tuple[float, float, float], model: MotionModel) -> tuple[float, float, float]:
    first, second, third = squares
    if model.kind.endswith("-corrected"):
        return math.sqrt(first), math.sqrt(second), math.sqrt(third)
    return squares
