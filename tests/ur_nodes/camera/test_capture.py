import errno

import numpy as np
import pytest
from tests.ur_nodes.camera.fake_device import FakeCamera, make_jpeg

from ur_nodes.camera import abi, controls
from ur_nodes.camera.capture import V4l2Camera
from ur_nodes.camera.source import Adjustments, CameraError, CameraSettings, Frame

JPEG = make_jpeg()


def open_camera(camera: FakeCamera, settings: CameraSettings | None = None) -> V4l2Camera:
    return V4l2Camera(camera.open("/dev/video0"), "/dev/video0", settings or CameraSettings())


def read(source: V4l2Camera) -> Frame:
    frame = source.read(1.0)
    assert frame is not None
    return frame


def test_jpeg_is_passed_on_as_it_comes() -> None:
    camera = FakeCamera()
    source = open_camera(camera)
    camera.feed(JPEG)
    frame = read(source)
    assert (frame.jpeg, frame.pixels) == (JPEG, None)
    assert 0.0 <= frame.age < 0.5
    mode = source.mode
    assert (mode.camera, mode.width, mode.height, mode.rate) == ("Fake Camera", 640, 480, 30.0)
    assert (mode.format, mode.passed_on) == ("MJPG", True)


def test_pictures_go_on_for_longer_than_there_are_buffers() -> None:
    camera = FakeCamera()
    source = open_camera(camera)
    for number in range(20):
        picture = make_jpeg(colour=(10 * number, 0, 0))
        camera.feed(picture)
        assert read(source).jpeg == picture


def test_of_several_pictures_that_wait_the_newest_is_read() -> None:
    camera = FakeCamera()
    source = open_camera(camera)
    for number in range(3):
        camera.feed(make_jpeg(colour=(50 * number, 0, 0)))
    assert read(source).jpeg == make_jpeg(colour=(100, 0, 0))
    assert source.read(0.0) is None


def test_bytes_after_the_end_of_a_jpeg_are_cut_off() -> None:
    camera = FakeCamera()
    source = open_camera(camera)
    camera.feed(JPEG + bytes(500))
    assert read(source).jpeg == JPEG


@pytest.mark.parametrize(
    ("picture", "flags"),
    [(JPEG[: len(JPEG) // 2], 0), (b"", 0), (JPEG, abi.BUF_ERROR), (b"nonsense", 0)],
)
def test_damaged_pictures_are_left_out(picture: bytes, flags: int) -> None:
    camera = FakeCamera()
    source = open_camera(camera)
    camera.feed(picture, flags)
    assert source.read(0.0) is None
    camera.feed(JPEG)
    assert read(source).jpeg == JPEG


def test_picture_that_nobody_wants_is_taken_off_the_camera_unread() -> None:
    camera = FakeCamera()
    source = open_camera(camera)
    camera.feed(JPEG)
    frame = source.read(1.0, wanted=False)
    assert frame is not None
    assert (frame.jpeg, frame.pixels) == (b"", None)
    assert not camera.pictures


def test_nearest_size_is_used_before_the_better_format() -> None:
    camera = FakeCamera({"MJPG": [(1920, 1080)], "YUYV": [(640, 480), (160, 120)]})
    mode = open_camera(camera).mode
    assert (mode.format, mode.width, mode.height, mode.passed_on) == ("YUYV", 640, 480, False)


def test_sizes_in_steps_are_met() -> None:
    camera = FakeCamera({"MJPG": [(32, 32), (1920, 1080), (8, 4)]})
    mode = open_camera(camera, CameraSettings(width=641, height=481)).mode
    assert (mode.width, mode.height) == (640, 480)


def test_raw_pictures_become_pixels() -> None:
    camera = FakeCamera({"YUYV": [(2, 2)]})
    source = open_camera(camera, CameraSettings(width=2, height=2))
    camera.feed(bytes([76, 85, 76, 255] * 2))  # ITU-R BT.601: red
    pixels = read(source).pixels
    assert pixels is not None
    assert np.abs(pixels.astype(int) - [254, 0, 0]).max() < 5


def test_camera_mirrors_by_itself_where_it_can() -> None:
    camera = FakeCamera(controls={controls.MIRROR: (0, 1, 1, 0), controls.FLIP: (0, 1, 1, 0)})
    source = open_camera(camera, CameraSettings(flip_horizontally=True, flip_vertically=True))
    assert (camera.values[controls.MIRROR], camera.values[controls.FLIP]) == (1, 1)
    assert source.mode.passed_on


def test_pictures_are_mirrored_here_where_the_camera_cannot() -> None:
    camera = FakeCamera()
    source = open_camera(camera, CameraSettings(flip_horizontally=True))
    assert not source.mode.passed_on
    camera.feed(JPEG)
    pixels = read(source).pixels
    assert pixels is not None
    assert pixels[10, -10, 0] > 150 > 50 > pixels[10, 10, 0]


def test_exposure_and_brightness_are_set_on_the_scale_of_the_camera() -> None:
    camera = FakeCamera(
        controls={
            controls.BRIGHTNESS: (-64, 64, 1, 0),
            controls.CONTRAST: (0, 95, 5, 30),
            controls.EXPOSURE_AUTO: (0, 3, 1, 3),
            controls.EXPOSURE_ABSOLUTE: (1, 5000, 1, 157),
        }
    )
    asked = Adjustments(brightness=75, contrast=-50, shutter_speed=20_000, sharpness=10)
    source = open_camera(camera, CameraSettings(adjustments=asked))
    assert camera.values[controls.BRIGHTNESS] == 32
    assert camera.values[controls.CONTRAST] == 15
    assert camera.values[controls.EXPOSURE_AUTO] == 1
    assert camera.values[controls.EXPOSURE_ABSOLUTE] == 200
    assert source.mode.missing == ("sharpness",)


def test_unplugging_is_reported_with_the_name_of_the_camera() -> None:
    camera = FakeCamera()
    source = open_camera(camera)
    camera.unplug()
    with pytest.raises(CameraError, match=r"the camera Fake Camera \(/dev/video0\) was unplugged"):
        source.read(1.0)
    source.close()
    source.close()
    assert camera.files[0].closed


def test_camera_in_use_leaves_nothing_open() -> None:
    camera = FakeCamera()
    camera.user = "another program"
    with pytest.raises(OSError, match="busy") as caught:
        open_camera(camera)
    assert caught.value.errno == errno.EBUSY
    assert camera.files[0].closed


@pytest.mark.parametrize("request_number", [abi.S_FMT, abi.REQBUFS, abi.QUERYBUF, abi.STREAMON, abi.ENUM_FMT])
def test_device_that_fails_half_way_is_closed(request_number: int) -> None:
    camera = FakeCamera()
    camera.refuse[request_number] = errno.EIO
    with pytest.raises(OSError, match="Input/output error"):
        open_camera(camera)
    assert camera.files[0].closed
    assert camera.user is None


def test_formats_that_cannot_be_used_are_named() -> None:
    camera = FakeCamera({"H264": [(640, 480)], "pBAA": [(640, 480)]})
    with pytest.raises(CameraError, match=r"gives H264, pBAA, expected one of MJPG") as caught:
        open_camera(camera)
    assert not caught.value.waits


def test_device_that_takes_no_pictures_is_no_camera() -> None:
    camera = FakeCamera(name="HD Webcam\x1b[2J")
    camera.capabilities = 0x00800000  # metadata of a camera
    with pytest.raises(CameraError, match=r"/dev/video0 \(HD Webcam\\x1b\[2J\) takes no pictures") as caught:
        open_camera(camera)
    assert not caught.value.waits
    camera.refuse[abi.QUERYCAP] = errno.ENOTTY
    with pytest.raises(CameraError, match="is no camera"):
        open_camera(camera)


def test_camera_that_cannot_set_its_rate_is_used_all_the_same() -> None:
    camera = FakeCamera()
    camera.refuse[abi.S_PARM] = errno.ENOTTY
    assert open_camera(camera).mode.rate == 0.0
