"""A camera for tests: publishes a picture, says what came back. A JSON request a line in, an answer a line out."""

from __future__ import annotations

import io
import time
from typing import Any

import numpy as np
import rospy
from PIL import Image as Picture
from sensor_msgs.msg import CompressedImage, Image
from tests.json_client import answer_requests, claim_output

COLOUR = (200, 40, 90)


class Client:
    """Publishes `camera/image/compressed` ten times a second while a request waits."""

    def __init__(self) -> None:
        self.publisher = rospy.Publisher("camera/image/compressed", CompressedImage, queue_size=1)
        self.newest: Image | None = None
        self.good = make_jpeg()

    def do_publish(self, bad: bool = False) -> dict[str, Any]:
        """One picture, or something that is none."""
        message = CompressedImage(format="jpeg", data=b"nonsense" if bad else self.good)
        message.header.frame_id, message.header.stamp = "raspicam", rospy.Time.now()
        self.publisher.publish(message)
        return {"listeners": self.publisher.get_num_connections()}

    def do_look(self, topic: str, seconds: float) -> dict[str, Any]:
        """Listen to a raw topic while publishing, until a picture comes."""
        self.newest = None
        subscriber = rospy.Subscriber(topic, Image, self._take, queue_size=1)
        end = time.monotonic() + seconds
        while self.newest is None and time.monotonic() < end:
            self.do_publish()
            time.sleep(0.1)
        subscriber.unregister()
        assert self.newest is not None, f"nothing on {topic}"
        pixels = np.frombuffer(self.newest.data, np.uint8).reshape(self.newest.height, self.newest.width, 3)
        header, encoding = self.newest.header, self.newest.encoding
        return {
            "frame": header.frame_id,
            "encoding": encoding,
            "shape": pixels.shape,
            "mean": pixels.mean((0, 1)).tolist(),
        }

    def do_listeners(self, wanted: int, seconds: float) -> dict[str, Any]:
        """Wait until so many listen to the compressed pictures."""
        end = time.monotonic() + seconds
        while self.publisher.get_num_connections() != wanted and time.monotonic() < end:
            time.sleep(0.02)
        return {"listeners": self.publisher.get_num_connections()}

    def _take(self, message: Image) -> None:
        self.newest = message


def make_jpeg() -> bytes:
    """A picture of one colour, 64 x 48."""
    file = io.BytesIO()
    Picture.new("RGB", (64, 48), COLOUR).save(file, "JPEG", quality=95)
    return file.getvalue()


def main() -> None:
    """Answer requests until standard input ends."""
    answers = claim_output()
    rospy.init_node("camera_client", anonymous=True, disable_signals=True)
    answer_requests(answers, Client(), "do_")


if __name__ == "__main__":
    main()
