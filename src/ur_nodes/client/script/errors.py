"""Errors of requests to a robot."""

import math


class RobotError(Exception):
    """A request was not carried out; the text is the reason, for users."""


class Refused(RobotError):  # noqa: N818 - named as users say it
    """The robot refuses: there is no path, the emergency stop is on, another client drives, or a sensor is missing."""


class Lost(RobotError):  # noqa: N818
    """Nothing is received from the robot, or from a node that the request needs."""


class TakenOver(RobotError):  # noqa: N818
    """Another client has taken over and drives the robot now."""


class Interrupted(RobotError):  # noqa: N818
    """The call was cancelled from another thread or task, and the motion that it had begun is stopped."""


def check_finite(**numbers: float) -> None:
    """Raise ValueError if a number is not finite."""
    for name, value in numbers.items():
        if not math.isfinite(value):
            raise ValueError(f"{name}: {value}, expected a finite number")
