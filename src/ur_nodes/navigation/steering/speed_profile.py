"""Speeds along a path and of turns on the spot, within the limits of the robot."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.grid import Grid
from ur_nodes.navigation.planning.path_geometry import Points, curvatures


class DriveVelocity(NamedTuple):
    """A velocity of the base: m/s ahead, rad/s, m/s to the left."""

    speed: float
    turn: float
    left: float = 0.0


AT_REST = DriveVelocity(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class SpeedLimits:
    """Limits of the robot: m/s, rad/s, m/s^2, rad/s^2. `backward` is the greatest speed backwards, as a positive.

    `radius` (m) is that of its narrowest bend, 0 when it turns on the spot. `lateral` is the greatest speed to either
    side, 0 when its wheels do not roll sideways.
    """

    speed: float
    turn: float
    acceleration: float
    turn_acceleration: float
    backward: float = 0.1
    radius: float = 0.0
    lateral: float = 0.0

    @property
    def bend(self) -> float:
        """The radius (m) of a bend that it drives at full speed, with some turn to spare for steering."""
        return self.speed / (0.9 * self.turn)

    def turn_at(self, speed: float, turn: float) -> float:
        """The turn (rad/s) nearest to `turn` that the robot can make at a speed."""
        if not self.radius:
            return turn
        most = abs(speed) / self.radius
        return max(-most, min(most, turn))


def limit_speeds(limits: SpeedLimits, share: float) -> SpeedLimits:
    """Return the limits with a share (0 to 1) of the speeds and the same accelerations."""
    return replace(
        limits,
        speed=share * limits.speed,
        turn=share * limits.turn,
        backward=share * limits.backward,
        lateral=share * limits.lateral,
    )


def speed_shares(mask: Grid | None, points: Points) -> NDArray[np.float64] | None:
    """The shares (n) of the speed limit that are allowed at points (n, 2) in m, from a mask of percentages.

    Cells that are 0, unknown or 100, and what lies beyond the mask, allow all of it. None without a mask.
    """
    if mask is None:
        return None
    percent = mask.values_at(points, outside=0).astype(np.float64)
    shares: NDArray[np.float64] = np.where((percent > 0.0) & (percent < 100.0), percent / 100.0, 1.0)
    return shares


def speed_profile(
    points: Points, limits: SpeedLimits, shares: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """The greatest speed (n) in m/s at each point of an evenly spaced path (n, 2) that ends at rest.

    Bounded by the speed limit, or the share (n) of it that is allowed at a point, by turn / curvature, and by braking
    in time with 0.85 of the acceleration for what comes later. Speeding up is left to the controller.
    """
    if len(points) < 2:
        return np.zeros(len(points))
    spacing = float(np.hypot(*(points[1] - points[0])))
    bend = np.abs(curvatures(points, 3))
    allowed = limits.speed if shares is None else shares * limits.speed
    speeds = np.minimum(allowed, 0.95 * limits.turn / np.maximum(bend, 1e-6))
    speeds[-1] = 0.0
    return brake_for(speeds, spacing, limits)


def brake_for(speeds: NDArray[np.float64], spacing: float, limits: SpeedLimits) -> NDArray[np.float64]:
    """Lower speeds (n) at points `spacing` m apart, so that braking is in time with 0.85 of the acceleration."""
    # v[i]^2 <= v[i+1]^2 + 2 a ds, for all later points at once: a running minimum of v^2 + 2 a s from the end.
    climb = 2.0 * 0.85 * limits.acceleration * spacing * np.arange(len(speeds))
    squares = np.minimum.accumulate((speeds**2 + climb)[::-1])[::-1] - climb
    fastest: NDArray[np.float64] = np.sqrt(np.maximum(squares, 0.0))
    return fastest


def turn_rate(error: float, limits: SpeedLimits) -> float:
    """Return the rate in rad/s at which to turn on the spot by `error` rad, braking with 0.7 of the acceleration."""
    return math.copysign(min(limits.turn, math.sqrt(2.0 * 0.7 * limits.turn_acceleration * abs(error))), error)


def turn_towards(error: float, turn: float, limits: SpeedLimits, period: float) -> float:
    """Return the rate in rad/s for the next period of a turn on the spot by `error` rad, which is at rate `turn` now.

    Near the end it is no more than gets there within a period and a half, so that the robot does not swing.
    """
    ahead = error - turn * period * 0.5
    most = abs(ahead) / (1.5 * period)
    rate = max(-most, min(most, turn_rate(ahead, limits)))
    return approach(turn, rate, limits.turn_acceleration * period)


def change_velocity(
    velocity: DriveVelocity, target: DriveVelocity, limits: SpeedLimits, period: float
) -> DriveVelocity:
    """Return the velocity after a period (s) on the way to another, with the accelerations of the limits."""
    step = limits.acceleration * period
    return DriveVelocity(
        approach(velocity.speed, target.speed, step),
        approach(velocity.turn, target.turn, limits.turn_acceleration * period),
        approach(velocity.left, target.left, step),
    )


def brake(velocity: DriveVelocity, limits: SpeedLimits, period: float) -> DriveVelocity:
    """Return the velocity after a period (s) of braking with the accelerations of the limits."""
    return change_velocity(velocity, AT_REST, limits, period)


def approach(value: float, target: float, step: float) -> float:
    """Return `target`, or the nearest value after a change of at most `step`."""
    return min(value + step, max(value - step, target))
