"""Values of fiducials: corners in a picture, poses relative to the camera, and poses in a map."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose3


@dataclass(frozen=True, slots=True, eq=False)
class FiducialCorners:
    """The corners (4, 2) float64 of a fiducial in a picture, px, from the top left clockwise as one reads it."""

    number: int
    corners: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class SeenFiducials:
    """The fiducials in a picture of the camera at `frame`; `picture` is the picture's `sequence`."""

    stamp: int
    frame: str
    picture: int
    fiducials: tuple[FiducialCorners, ...]


@dataclass(frozen=True, slots=True)
class FiducialPose:
    """The pose of a fiducial in the camera's frame; its error in px and in m at the fiducial; its area in px^2."""

    number: int
    pose: Pose3
    image_error: float
    object_error: float
    area: float


@dataclass(frozen=True, slots=True)
class StampedFiducials:
    """The fiducials in a picture, with poses."""

    stamp: int
    frame: str
    picture: int
    fiducials: tuple[FiducialPose, ...]


@dataclass(frozen=True, slots=True)
class MappedFiducial:
    """The place of a fiducial in the map, x, y, z in m, and roll, pitch, yaw in rad."""

    number: int
    position: tuple[float, float, float]
    angles: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class MappedFiducials:
    """All fiducials of a map."""

    fiducials: tuple[MappedFiducial, ...]
