"""Connections, for nodes that are still written against rospy."""

from __future__ import annotations

from ur_nodes.ros1.repairs.connections import bound_connections as bound_connections
