"""An edge of the pose graph: the relative pose of two keyframes, and its uncertainty."""

from __future__ import annotations

from typing import NamedTuple

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.surface import Floats


class Edge(NamedTuple):
    """The pose of keyframe `after` in the frame of `before`, with a covariance (3, 3); robust: unless contradicted."""

    before: int
    after: int
    relative: Pose2
    covariance: Floats
    robust: bool
