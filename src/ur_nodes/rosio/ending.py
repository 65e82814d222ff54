"""Callbacks that the end of a node overtakes, for nodes that are still written against rospy."""

from __future__ import annotations

from ur_nodes.ros1.ending import quiet_at_end as quiet_at_end
