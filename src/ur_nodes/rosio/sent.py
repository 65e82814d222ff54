"""Memory of large messages, for nodes that are still written against rospy."""

from __future__ import annotations

from ur_nodes.ros1.repairs.sent import SentMessages as SentMessages
