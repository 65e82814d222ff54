"""A node that publishes one compressed picture again and again: python -m tests.e2e.camera_publisher."""

from __future__ import annotations

import rospy
from sensor_msgs.msg import CompressedImage

PICTURE = bytes(range(256)) * 4


def main() -> None:
    rospy.init_node("camera_of_test")
    publisher = rospy.Publisher("raspicam_node/image/compressed", CompressedImage, queue_size=1)
    message = CompressedImage(format="jpeg", data=PICTURE)
    while not rospy.is_shutdown():
        message.header.seq += 1
        publisher.publish(message)
        rospy.rostime.wallsleep(0.1)


if __name__ == "__main__":
    main()
