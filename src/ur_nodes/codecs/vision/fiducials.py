"""Fiducials: messages of fiducial_msgs on ROS 1; on ROS 2, where no distribution has that package, JSON in strings."""

from ur_nodes.codecs.dialect import ROS_2

if ROS_2:
    from ur_nodes.codecs.vision.fiducial_texts import CODECS
else:
    from ur_nodes.codecs.vision.fiducial_messages import CODECS

__all__ = ["CODECS"]
