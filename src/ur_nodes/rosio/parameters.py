"""Parameters of a node, for nodes that are still written against rospy."""

from __future__ import annotations

from ur_nodes.ports import parameters
from ur_nodes.ros1.facts import RosParameters


class Parameters(parameters.Parameters):
    """Parameters below `namespace` ('~' is the node itself)."""

    def __init__(self, namespace: str = "~") -> None:
        super().__init__(RosParameters(), namespace)
