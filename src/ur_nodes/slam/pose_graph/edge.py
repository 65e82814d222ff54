"""An edge of the pose graph: the relative pose of two keyframes, and its uncertainty."""

from collections.abc import Sequence
from typing import NamedTuple

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.surface import Floats


class Edge(NamedTuple):
    """The pose of keyframe `after` in the frame of `before`, with a covariance (3, 3); robust: unless contradicted."""

    before: int
    after: int
    relative: Pose2
    covariance: Floats
    robust: bool


def find_drives(edges: Sequence[Edge], count: int) -> list[int]:
    """Return the numbers of the keyframes at which a later drive begins: only robust edges lead to them."""
    tied = {edge.after for edge in edges if not edge.robust}
    return [number for number in range(1, count) if number not in tied]
