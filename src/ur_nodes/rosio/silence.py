"""Reasons for silence, for nodes that are still written against rospy."""

from __future__ import annotations

from ur_nodes.ros1.silence import SilenceMonitor as SilenceMonitor
