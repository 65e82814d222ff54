from dataclasses import replace
from pathlib import Path

import pytest
from tests.ur_nodes.camera.fake_device import FakeCamera, FakeFile

from ur.devices.known import Device, DeviceSnapshot
from ur_nodes.camera.capture import V4l2Camera
from ur_nodes.camera.finder import CameraFinder, FinderSystem
from ur_nodes.camera.source import CameraError, CameraSettings, PictureSource


class ComputerWithDevices:
    """Cameras by their paths, and what an inspection shows of them."""

    def __init__(self, folder: Path) -> None:
        self.cameras: dict[str, FakeCamera] = {}
        self.devices: dict[str, Device] = {}
        self.inspections = 0
        self.now = 0.0
        self.system = FinderSystem(
            open_device=self.open,
            inspect=self.inspect,
            is_raspberry=lambda: False,
            clock=lambda: self.now,
            devices=folder,
        )

    def plug(self, path: str, usb: str, *, serial: str = "", port: str = "1-1") -> FakeCamera:
        self.cameras[path] = camera = FakeCamera()
        self.devices[path] = Device(path, "camera", usb, serial, product="Camera", driver="uvcvideo", port=port)
        (self.system.devices / path.rpartition("/")[2]).touch()
        return camera

    def unplug(self, path: str) -> None:
        self.cameras.pop(path).unplug()
        del self.devices[path]
        (self.system.devices / path.rpartition("/")[2]).unlink()

    def open(self, path: str) -> FakeFile:
        if path not in self.cameras:
            raise FileNotFoundError(2, "No such file or directory", path)
        return self.cameras[path].open(path)

    def inspect(self) -> DeviceSnapshot:
        self.inspections += 1
        return DeviceSnapshot("pat", devices=tuple(self.devices.values()))


@pytest.fixture
def computer(tmp_path: Path) -> ComputerWithDevices:
    return ComputerWithDevices(tmp_path)


def test_camera_that_comes_back_under_another_name_is_found(computer: ComputerWithDevices) -> None:
    computer.plug("/dev/video0", "046d:082d", serial="A1")
    finder = CameraFinder(CameraSettings(), system=computer.system)
    finder.open().close()
    assert "/dev/video0" in finder.description
    computer.unplug("/dev/video0")
    with pytest.raises(CameraError, match="was unplugged"):
        finder.open()
    computer.plug("/dev/video5", "046d:082d", serial="A1", port="2-1")
    assert finder.open().mode.path == "/dev/video5"


def test_another_camera_does_not_take_the_place_of_the_one_that_was_unplugged(computer: ComputerWithDevices) -> None:
    computer.plug("/dev/video0", "046d:082d", port="1-1")
    computer.plug("/dev/video2", "046d:082d", port="1-2")  # the same model, without serial numbers
    finder = CameraFinder(CameraSettings(), system=computer.system)
    finder.open().close()
    computer.unplug("/dev/video0")
    with pytest.raises(CameraError, match="was unplugged"):
        finder.open()
    computer.plug("/dev/video0", "046d:082d", port="1-1")
    assert finder.open().mode.path == "/dev/video0"


def test_two_cameras_are_read_side_by_side(computer: ComputerWithDevices) -> None:
    computer.plug("/dev/video0", "046d:082d")
    computer.plug("/dev/video2", "0c45:6366")
    first = CameraFinder(CameraSettings(), system=computer.system).open()
    second = CameraFinder(CameraSettings(), number=1, system=computer.system).open()
    assert (first.mode.path, second.mode.path) == ("/dev/video0", "/dev/video2")
    with pytest.raises(CameraError, match="in use"):
        CameraFinder(CameraSettings(), system=computer.system).open()


def test_devices_are_inspected_again_when_one_changes_or_after_a_while(computer: ComputerWithDevices) -> None:
    finder = CameraFinder(CameraSettings(), system=computer.system)
    for _ in range(5):
        with pytest.raises(CameraError, match="no camera is there"):
            finder.open()
    assert computer.inspections == 1
    computer.now = 11.0
    with pytest.raises(CameraError, match="no camera is there"):
        finder.open()
    assert computer.inspections == 2
    computer.plug("/dev/video0", "046d:082d")
    finder.open().close()
    assert computer.inspections == 3


def test_ribbon_camera_is_opened_by_libcamera(computer: ComputerWithDevices) -> None:
    opened = []
    computer.plug("/dev/video0", "")
    computer.devices["/dev/video0"] = Device("/dev/video0", "camera", driver="unicam")

    def open_libcamera(number: int, settings: CameraSettings) -> PictureSource:
        opened.append((number, settings.width))
        return V4l2Camera(FakeCamera().open(""), "", settings)

    system = replace(computer.system, open_libcamera=open_libcamera)
    CameraFinder(CameraSettings(width=320), system=system).open()
    assert opened == [(0, 320)]
