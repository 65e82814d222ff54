"""Watches fiducial_detect and fiducial_slam for the tests, and prints what came as one line of JSON."""

from __future__ import annotations

import json
import sys
import threading
from typing import Any

import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
from sensor_msgs.msg import Image
from tests.json_client import claim_output
from tests.ur_nodes.vision.synthetic import MOUNT
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from ur_nodes.codecs.geometry import transform_message
from ur_nodes.codecs.vision.fiducial_messages import message_classes
from ur_nodes.geometry.rigid import to_pose


def main() -> None:
    answers = claim_output()
    rospy.init_node("client", anonymous=True, disable_signals=True)
    mount = TransformStamped(child_frame_id="raspicam", transform=transform_message(to_pose(MOUNT)))
    mount.header.frame_id = "base_footprint"
    static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
    static.publish(TFMessage([mount]))
    arrived: dict[str, Any] = {}
    full = threading.Event()

    def take(message: Any, topic: str) -> None:
        if topic == "tf":
            found = [each for each in message.transforms if each.child_frame_id == "odom"]
            if found:
                arrived["tf"] = [found[0].header.frame_id, found[0].transform.translation.x]
        elif topic == "fiducial_transforms" and message.transforms:
            arrived[topic] = [[each.fiducial_id, each.image_error] for each in message.transforms]
            arrived["frame"] = message.header.frame_id
        elif topic == "fiducials" and len(message.markers) > 1:
            arrived[topic] = len(message.markers)
        elif topic == "fiducial_map" and message.fiducials:
            arrived[topic] = {each.fiducial_id: [each.x, each.y, each.z] for each in message.fiducials}
        elif topic == "fiducial_pose":
            place = message.pose.pose.position
            arrived[topic] = [place.x, place.y, *message.pose.covariance[:2]]
        elif topic == "fiducial_images":
            arrived[topic] = [message.width, message.height]
        if set(sys.argv[1].split(",")) <= set(arrived):
            full.set()

    kinds = {
        "tf": TFMessage,
        "fiducials": MarkerArray,
        "fiducial_pose": PoseWithCovarianceStamped,
        "fiducial_images": Image,
        "fiducial_transforms": message_classes("FiducialTransformArray")[0],
        "fiducial_map": message_classes("FiducialMapEntryArray")[0],
    }
    for topic, kind in kinds.items():
        rospy.Subscriber(f"/{topic}", kind, take, topic)
    arrived["complete"] = full.wait(60.0)
    answers.write(json.dumps(arrived) + "\n")
    answers.flush()
    rospy.signal_shutdown("done")


if __name__ == "__main__":
    main()
