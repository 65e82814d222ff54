"""Requests of services. What they are answered with is `Result.value`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.values import Calibration, Map, PlacedPose


@dataclass(frozen=True, slots=True)
class Trigger:
    """Do what the service is named after."""


@dataclass(frozen=True, slots=True)
class Silent:
    """As Trigger, for services whose answer carries nothing (std_srvs/Empty)."""


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
    """Put a thing of a simulated world, by name, at a pose in a frame."""

    name: str
    frame: str
    pose: Pose2


@dataclass(frozen=True, slots=True)
class AskPath:
    """Answered with a `Path` from one pose to the other, ending within `tolerance` m."""

    start: PlacedPose
    goal: PlacedPose
    tolerance: float


@dataclass(frozen=True, slots=True)
class UseCalibration:
    """Use a calibration from now on, and keep it."""

    calibration: Calibration


READING = (AskMap, AskPath)
"""Requests that change nothing: they can be sent again where no answer has come."""
