"""Errors of requests to a robot."""

from __future__ import annotations

import math


class RobotError(Exception):
    """A request that was not carried out; the text is the reason, for people."""


class Refused(RobotError):  # noqa: N818 - named as users say it
    """The robot's side does not do it: no way there, an emergency stop, another client drives, no such sensor."""


class Lost(RobotError):  # noqa: N818
    """Nothing arrives from the robot, or from a part of it that is needed."""


class TakenOver(RobotError):  # noqa: N818
    """Another client has taken over; the robot obeys that one now."""


class Interrupted(RobotError):  # noqa: N818
    """The call was cancelled from another thread or task; what it had begun is stopped."""


def check_finite(**numbers: float) -> None:
    """Raise ValueError: a number is not finite."""
    for name, value in numbers.items():
        if not math.isfinite(value):
            raise ValueError(f"{name}: {value}, expected a finite number")
