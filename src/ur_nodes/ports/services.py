"""Requests of services. The answer is `Result.value`."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.values import Calibration, Map, StampedPose


@dataclass(frozen=True, slots=True)
class Trigger:
    """Trigger the action that the service is named after."""


@dataclass(frozen=True, slots=True)
class Silent:
    """Trigger a service whose answer is empty (std_srvs/Empty)."""


@dataclass(frozen=True, slots=True)
class Switch:
    """Turn something on or off."""

    on: bool


@dataclass(frozen=True, slots=True)
class AskMap:
    """Answered with a `Map`."""


@dataclass(frozen=True, slots=True, eq=False)
class UseMap:
    """Use a map from now on, with the robot at a pose in it."""

    map: Map
    stamp: int
    frame: str
    pose: Pose2
    covariance: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Place:
    """Move an object of a simulated world, by name, to a pose in a frame."""

    name: str
    frame: str
    pose: Pose2


@dataclass(frozen=True, slots=True)
class AskPath:
    """Answered with a `Path` from one pose to the other, ending within `tolerance` m."""

    start: StampedPose
    goal: StampedPose
    tolerance: float


@dataclass(frozen=True, slots=True)
class UseCalibration:
    """Use a calibration from now on, and keep it."""

    calibration: Calibration


@dataclass(frozen=True, slots=True)
class LoadMap:
    """Serve another map file from now on, by its path or `file://`. Answered with its `Map`.

    A failure has a `MapProblem` as its value.
    """

    file: str


class MapProblem(IntEnum):
    """The reason why a map was not loaded, as nav_msgs/LoadMap and nav2_msgs/LoadMap number it."""

    MISSING = 1
    UNUSABLE = 2


@dataclass(frozen=True, slots=True)
class ClearCostmap:
    """Forget the obstacles of a costmap."""


READING = (AskMap, AskPath)
"""Requests that change nothing: they can be sent again where no answer has come."""
