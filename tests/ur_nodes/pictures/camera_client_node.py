"""A camera for tests: publishes a picture, says what came back. A JSON request a line in, an answer a line out."""

from __future__ import annotations

import io
from typing import Any

import rospy
from PIL import Image as Picture
from sensor_msgs.msg import CompressedImage
from tests.json_client import answer_requests, claim_output

COLOUR = (200, 40, 90)


class PictureClient:
    """Publishes `camera/image/compressed` ten times a second while a request waits."""

    def __init__(self) -> None:
        self.publisher = rospy.Publisher("camera/image/compressed", CompressedImage, queue_size=1)
        self.good = make_jpeg()

    def do_publish(self, bad: bool = False) -> dict[str, Any]:
        """One picture, or something that is none."""
        message = CompressedImage(format="jpeg", data=b"nonsense" if bad else self.good)
        message.header.frame_id, message.header.stamp = "raspicam", rospy.Time.now()
        self.publisher.publish(message)
        return {"subscribers": self.publisher.get_num_connections()}


def make_jpeg() -> bytes:
    """A picture of one colour, 64 x 48."""
    file = io.BytesIO()
    Picture.new("RGB", (64, 48), COLOUR).save(file, "JPEG", quality=95)
    return file.getvalue()


def main() -> None:
    """Answer requests until standard input ends."""
    answers = claim_output()
    rospy.init_node("camera_client", anonymous=True, disable_signals=True)
    answer_requests(answers, PictureClient(), "do_")


if __name__ == "__main__":
    main()
