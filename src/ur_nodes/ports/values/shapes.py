"""Shapes and points in space, for viewers."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose3

Shape = Literal[
    "arrow", "cube", "sphere", "cylinder", "line_strip", "line_list", "cube_list", "sphere_list", "points", "text",
    "triangles",
]  # fmt: skip
MarkerAction = Literal["put", "delete", "clear"]


@dataclass(frozen=True, slots=True, eq=False)
class Marker:
    """A shape for viewers, identified by `namespace` and `number`. `colour` is red, green, blue, opacity, 0 to 1.

    A cube has a `size` of x, y, z in m, a text the height of its letters in z, points (n, 3) in m their sides in x, y.
    `colours` (n, 4) are those of the points, where they differ.
    """

    namespace: str
    number: int
    shape: Shape
    pose: Pose3
    size: tuple[float, float, float]
    colour: tuple[float, float, float, float]
    text: str = ""
    points: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))
    colours: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 4)))


@dataclass(frozen=True, slots=True, eq=False)
class Markers:
    """Shapes in a frame, which replace all earlier ones of the topic."""

    stamp: int
    frame: str
    markers: tuple[Marker, ...]


@dataclass(frozen=True, slots=True, eq=False)
class MarkerChange:
    """A change of the shapes of a topic: add or replace a marker, delete it, or delete all.

    A marker is shown for `lifetime` s; 0: until it is deleted.
    """

    stamp: int
    frame: str
    action: MarkerAction
    marker: Marker
    lifetime: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class MarkerChanges:
    """Changes in their order."""

    changes: tuple[MarkerChange, ...]


@dataclass(frozen=True, slots=True, eq=False)
class PointCloud:
    """Points in a frame: a structured array (n,) with the fields x, y, z in m and, where they have one, rgb.

    The numbers are of any type, not always finite; rgb is an unsigned 32-bit 0xRRGGBB. The memory is that of the
    message, with the other fields of each point in between.
    """

    stamp: int
    frame: str
    points: NDArray[np.void]
