import pytest
from tests.ur_nodes.pictures.test_decode import make_picture as make_pixels
from tests.ur_nodes.pictures.test_decode import pack

from ur.source.diagnostic import UserError
from ur_nodes.memory.bus import Bus
from ur_nodes.pictures.decode import decode_picture
from ur_nodes.pictures.republish_node import start
from ur_nodes.ports.values import PackedPicture, Picture

DATA = pack(make_pixels(), "JPEG")


@pytest.fixture
def bus() -> Bus:
    argv = ["compressed", "in:=camera/image", "raw", "out:=camera/unpacked"]
    bus = Bus()
    start(bus.node("republish", {"in": "/camera/image", "out": "/camera/unpacked"}), argv)
    return bus


def test_compressed_pictures_are_unpacked_while_there_are_subscribers(bus: Bus) -> None:
    camera, viewer = bus.node("camera"), bus.node("viewer")
    pictures = camera.publish("camera/image/compressed", PackedPicture)
    got: list[Picture] = []
    bus.run(1.0)
    assert pictures.subscribers() == 0
    subscription = viewer.subscribe("camera/unpacked", Picture, got.append)
    bus.run(1.0)
    assert pictures.subscribers() == 1
    pictures.send(PackedPicture(7, "raspicam", "jpeg", DATA))
    bus.run(0.1)
    assert got == [Picture(7, "raspicam", 64, 48, "rgb8", 192, decode_picture(DATA).tobytes())]
    subscription.close()
    bus.run(1.0)
    assert pictures.subscribers() == 0


def test_picture_that_is_none_is_reported(bus: Bus) -> None:
    pictures = bus.node("camera").publish("camera/image/compressed", PackedPicture)
    bus.node("viewer").subscribe("camera/unpacked", Picture, lambda _picture: None)
    bus.run(1.0)
    pictures.send(PackedPicture(7, "raspicam", "jpeg", b"nonsense"))
    bus.run(0.1)
    ((level, text),) = bus.nodes["/republish"].lines
    assert level == "warn"
    assert text.startswith("/camera/image/compressed: 8 bytes")


def test_republish_with_other_arguments_is_refused() -> None:
    with pytest.raises(UserError, match="arguments: theora, expected compressed raw"):
        start(Bus().node("republish"), ["theora", "in:=a"])
