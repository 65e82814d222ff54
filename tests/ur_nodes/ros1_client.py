"""Parts of the clients that tests start as nodes of ROS 1."""

from __future__ import annotations

import rospy
from geometry_msgs.msg import TransformStamped
from tests.json_client import answer_requests, claim_output

from ur_nodes.codecs.geometry import transform_message
from ur_nodes.geometry.pose import Pose2


def stamped_transform(parent: str, child: str, pose: Pose2, stamp: rospy.Time) -> TransformStamped:
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id, message.header.stamp = parent, child, stamp
    message.transform = transform_message(pose)
    return message


def run_client(kind: type[object]) -> None:
    """Be a node whose requests a client of this kind answers, until there are no more."""
    answers = claim_output()
    rospy.init_node("client", anonymous=True, disable_signals=True)
    answer_requests(answers, kind())
    rospy.signal_shutdown("done")
