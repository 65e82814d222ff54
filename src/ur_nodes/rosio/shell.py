"""The frame of a node, for nodes that are still written against rospy."""

from __future__ import annotations

from ur_nodes.ros1.run import run_node as run_node
