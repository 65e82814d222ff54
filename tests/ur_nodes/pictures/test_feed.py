"""Pictures of a topic on a bus: what has arrived, and why nothing does."""

import io

import pytest
from PIL import Image

from ur_nodes.memory.bus import Bus
from ur_nodes.pictures.decode import BadPictureError
from ur_nodes.pictures.feed import PictureFeed, decode_view
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import LogLine, PackedPicture, Picture

TOPIC = "/camera/image/compressed"


def encode(size: tuple[int, int]) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", size, (200, 40, 90)).save(file, "JPEG")
    return file.getvalue()


JPEG = PackedPicture(0, "camera", "jpeg", encode((64, 48)))


def test_view_has_the_newest_picture_its_size_and_the_rate() -> None:
    bus = Bus()
    feed = PictureFeed(bus.node("viewer"), "camera/image")
    pictures = bus.node("camera").publish(TOPIC, PackedPicture)
    bus.node("clock").every(0.1, lambda: pictures.send(JPEG))
    bus.run(5.0)
    assert (feed.view.topic, feed.view.size, feed.view.length) == (TOPIC, (64, 48), len(JPEG.data))
    assert feed.view.rate == pytest.approx(10.0)
    assert (feed.view.number, feed.view.publishers, feed.view.silent, feed.view.reason) == (50, 1, False, "")
    pixels = decode_view(feed.view)
    assert pixels is not None
    assert pixels.shape == (48, 64, 3)


def test_pictures_that_are_not_packed_are_unpacked() -> None:
    bus = Bus()
    feed = PictureFeed(bus.node("viewer"), "camera/image", packed=False)
    pictures = bus.node("camera").publish("camera/image", Picture)
    pictures.send(Picture(0, "camera", 2, 1, "rgb8", 6, bytes(range(6))))
    bus.run(0.1)
    pixels = decode_view(feed.view)
    assert pixels is not None
    assert pixels.tolist() == [[[0, 1, 2], [3, 4, 5]]]
    pictures.send(Picture(0, "camera", 2, 1, "yuv", 6, bytes(range(6))))
    bus.run(0.1)
    with pytest.raises(BadPictureError, match="encoding 'yuv'"):
        decode_view(feed.view)


def test_data_that_is_no_picture_is_logged_and_does_not_count() -> None:
    bus = Bus()
    node = bus.node("viewer")
    feed = PictureFeed(node, "camera/image")
    bus.node("camera").publish(TOPIC, PackedPicture).send(PackedPicture(0, "camera", "jpeg", b"rubbish"))
    bus.run(0.1)
    assert (feed.view.number, feed.view.picture) == (0, None)
    assert [level for level, text in node.lines if text.startswith(TOPIC)] == ["warn"]


def test_reason_for_silence_is_known_after_three_seconds_and_forgotten_with_the_next_picture() -> None:
    bus = Bus()
    feed = PictureFeed(bus.node("viewer"), "camera/image")
    bus.run(2.9)
    assert (feed.view.silent, feed.view.reason) == (False, "")
    bus.run(1.0)
    assert (feed.view.silent, feed.view.reason) == (True, "no node publishes it")
    camera = bus.node("camera")
    pictures = camera.publish(TOPIC, PackedPicture)
    log = camera.publish("/rosout", LogLine, Quality.LATCHED)
    bus.run(2.5)
    assert feed.view.reason == "/camera publishes it, but sends nothing"
    log.send(LogLine("/camera", "warn", "the lens is dirty"))
    log.send(LogLine("/camera", "error", "the lens is \x1bmissing"))
    bus.run(0.5)
    assert feed.view.reason.startswith("/camera: the lens is ")
    assert "\x1b" not in feed.view.reason
    pictures.send(JPEG)
    bus.run(0.5)
    assert (feed.view.silent, feed.view.reason) == (False, "")
    bus.run(4.0)
    assert feed.view.reason.startswith("/camera: the lens is "), "the log kept its last line"
