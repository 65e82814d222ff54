"""A map at one moment, as it is drawn and stored."""

from collections.abc import Sequence
from dataclasses import dataclass

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.pose_graph.edge import Edge


@dataclass(frozen=True, slots=True, eq=False)
class MapState:
    """Keyframes with their scans, and the edges between them.

    `drives` are the numbers of the keyframes with which a later drive begins.
    """

    poses: Sequence[Pose2]
    edges: Sequence[Edge]
    scans: Sequence[MapScan]
    drives: Sequence[int] = ()
