import errno
import os

import pytest

from ur.devices.known import Device, DeviceHolder, DeviceSnapshot
from ur_nodes.camera.finder import choose_camera, describe_choice, explain_failure
from ur_nodes.camera.source import CameraError

FIRST = Device("/dev/video0", "camera", "046d:082d", "A1", "Logitech", "HD Pro Webcam C920", "uvcvideo", "1-1")
SECOND = Device(
    "/dev/video2", "camera", "0c45:6366", "", "", "USB Live camera", "uvcvideo", "1-2", links=("/dev/v4l/by-id/live",)
)
RIBBON = Device("/dev/video4", "camera", product="unicam-image", driver="unicam")
LIDAR = Device("/dev/ttyUSB0", "serial", "10c4:ea60", product="CP2102 USB to UART Bridge Controller")
TWO = DeviceSnapshot("pat", devices=(LIDAR, FIRST, SECOND))


def find(snapshot: DeviceSnapshot, wanted: str = "", number: int = 0, *, raspberry: bool = False) -> str:
    return choose_camera(snapshot, wanted, number, raspberry=raspberry).path


def refuse(snapshot: DeviceSnapshot, wanted: str = "", number: int = 0, *, raspberry: bool = False) -> CameraError:
    with pytest.raises(CameraError) as caught:
        find(snapshot, wanted, number, raspberry=raspberry)
    return caught.value


def test_first_camera_is_used_and_others_by_number_name_or_path() -> None:
    assert find(TWO) == "/dev/video0"
    assert find(TWO, number=1) == "/dev/video2"
    assert find(TWO, "live") == "/dev/video2"
    assert find(TWO, "c920") == "/dev/video0"
    assert find(TWO, "/dev/v4l/by-id/live") == "/dev/video2"


def test_path_that_is_not_known_is_tried_all_the_same() -> None:
    assert find(DeviceSnapshot(), "/dev/video7") == "/dev/video7"


def test_camera_on_the_ribbon_is_read_by_libcamera() -> None:
    snapshot = DeviceSnapshot(devices=(FIRST, RIBBON))
    assert choose_camera(snapshot, "", 1, raspberry=True).number == 1
    assert find(snapshot) == ""
    assert find(snapshot, "/dev/video4") == ""
    assert find(snapshot, "c920") == "/dev/video0"
    assert find(TWO, "libcamera") == ""


def test_without_a_camera_it_is_told_where_it_was_looked_for_and_what_to_do() -> None:
    problem = refuse(DeviceSnapshot(devices=(LIDAR,)))
    assert problem.reason.startswith("no camera is there: looked for USB cameras (/dev/video*)")
    assert "plug a USB camera in" in problem.help
    assert problem.waits
    ribbon = refuse(DeviceSnapshot(), raspberry=True).help
    assert "dtoverlay=imx219" in ribbon
    assert "both ends" in ribbon
    assert "container" in refuse(DeviceSnapshot(container=True)).help


def test_wish_that_no_camera_meets_lists_those_that_are_there() -> None:
    problem = refuse(TWO, "kinect")
    assert "with 'kinect' in its name" in problem.reason
    assert "/dev/video0 (" in problem.help
    assert "no camera 2 is there, counted from 0" in refuse(TWO, number=2).reason


def test_device_of_another_kind_is_named() -> None:
    problem = refuse(TWO, "/dev/ttyUSB0")
    assert problem.reason.startswith("/dev/ttyUSB0 is no camera but")
    assert not problem.waits


def explain(device: Device, number: int, **values: object) -> CameraError:
    fields = {"user": "pat", "devices": (device,), **values}
    return explain_failure(DeviceSnapshot(**fields), device.path, OSError(number, os.strerror(number)))  # type: ignore[arg-type]


def test_program_that_uses_the_camera_is_named_with_its_process() -> None:
    held = Device("/dev/video0", "camera", holders=(DeviceHolder(812, "cheese", "pat"),))
    problem = explain(held, errno.EBUSY)
    assert "is in use by cheese, process 812" in problem.reason
    assert problem.help == "end it: cheese, process 812, of pat"
    assert "in use by another program" in explain(FIRST, errno.EBUSY).reason


def test_missing_group_is_named() -> None:
    shut = Device("/dev/video0", "camera", mode=0o660, group="video", allowed=False)
    problem = explain(shut, errno.EACCES)
    assert problem.reason.startswith("pat may not open the camera /dev/video0")
    assert problem.help == "sudo usermod --append --groups video pat, then log in again"
    member = explain(shut, errno.EACCES, member=frozenset({"video"}))
    assert "log in again" in member.help


def test_full_usb_bus_and_other_failures_have_their_own_advice() -> None:
    assert "USB bus" in explain(FIRST, errno.ENOSPC).reason
    assert "is not there" in explain(FIRST, errno.ENODEV).reason
    assert "Input/output error" in explain(FIRST, errno.EIO).reason


def test_camera_is_described_with_path_and_number() -> None:
    text = describe_choice(choose_camera(TWO, "", 0, raspberry=False))
    assert "/dev/video0" in text
    assert "046d:082d, number A1" in text
