"""Poses and messages, for nodes that are still written against rospy."""

from __future__ import annotations

from ur_nodes.codecs.geometry import pose3_of_transform as pose3_of_transform
from ur_nodes.codecs.geometry import pose_message as pose_message
from ur_nodes.codecs.geometry import pose_of_message as pose_of_message
from ur_nodes.codecs.geometry import transform_message as transform_message
