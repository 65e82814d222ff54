from __future__ import annotations

import io
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("rospy", reason="ROS is not installed")
from PIL import Image

from ur_nodes.pictures.decode import BadPictureError
from ur_nodes.web.layers.camera_node import choose_topic, compress

RAW, JPEG = "sensor_msgs/Image", "sensor_msgs/CompressedImage"


def test_compressed_pictures_are_chosen_before_raw_ones() -> None:
    topics = [("/a/image", RAW), ("/scan", "sensor_msgs/LaserScan"), ("/cam/image/compressed", JPEG)]
    assert choose_topic(topics) == ("/cam/image/compressed", JPEG)
    assert choose_topic(topics[:2]) == ("/a/image", RAW)
    assert choose_topic(topics[1:2]) is None


def test_raw_pictures_become_small_jpegs() -> None:
    pixels = np.zeros((720, 1280, 3), np.uint8)
    pixels[:, :640] = (200, 30, 30)
    message = SimpleNamespace(data=pixels.tobytes(), width=1280, height=720, step=3840, encoding="rgb8")
    data = compress(message)
    picture = Image.open(io.BytesIO(data))
    assert (picture.format, picture.size) == ("JPEG", (640, 360))
    red, _, _ = picture.convert("RGB").getpixel((10, 10))  # type: ignore[misc]
    assert red > 150
    with pytest.raises(BadPictureError):
        compress(SimpleNamespace(data=b"", width=1280, height=720, step=3840, encoding="rgb8"))
