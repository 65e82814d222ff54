"""raspicam_node with cameras that are not there. A line on standard input unplugs one and plugs it in: `unplug 0`.

Arguments: the number of cameras, pictures a second, a JPEG that they take, or a folder of them, and a topic whose
pictures they take instead if the file is ''. The rest is for the node.
"""

from __future__ import annotations

import sys
import tempfile
import threading
from pathlib import Path

import rospy
from sensor_msgs.msg import CompressedImage
from tests.ur_nodes.camera.fake_device import FakeCamera, FakeFile

from ur.devices.known import Device, DeviceSnapshot
from ur_nodes.camera.finder import FinderSystem
from ur_nodes.camera.raspicam_node import main

HOLD = 15  # pictures that a camera takes of each file


class ComputerWithCameras:
    """The cameras that are plugged in, by their paths."""

    def __init__(self, count: int, rate: float, picture: str, folder: Path, *, patient: bool = True) -> None:
        film = [path.read_bytes() for path in list_pictures(picture) for _ in range(HOLD)] if picture else []
        self._cameras = [FakeCamera(rate=rate if film else 0.0, film=film, patient=patient) for _ in range(count)]
        self._folder = folder
        for number in range(count):
            self.plug(number)

    def plug(self, number: int) -> None:
        self._cameras[number].plug()
        (self._folder / f"video{2 * number}").touch()

    def unplug(self, number: int) -> None:
        (self._folder / f"video{2 * number}").unlink()
        self._cameras[number].unplug()

    def busy(self, number: int) -> None:
        """Another program streams."""
        self._cameras[number].user = "another program"

    def feed(self, data: bytes) -> None:
        for camera in self._cameras:
            camera.feed(data)

    def system(self) -> FinderSystem:
        """The parts of the computer that a node needs."""
        return FinderSystem(
            open_device=self.open, inspect=self.inspect, is_raspberry=lambda: False, devices=self._folder
        )

    def open(self, path: str) -> FakeFile:
        return self._cameras[int(path.removeprefix("/dev/video")) // 2].open(path)

    def inspect(self) -> DeviceSnapshot:
        found = [
            Device(f"/dev/video{2 * n}", "camera", "046d:082d", f"A{n}", "Logitech", "C920", "uvcvideo", f"1-{n}")
            for n, camera in enumerate(self._cameras)
            if camera.plugged
        ]
        return DeviceSnapshot("pat", devices=tuple(found))


def list_pictures(picture: str) -> list[Path]:
    return sorted(Path(picture).glob("*.jpg")) if Path(picture).is_dir() else [Path(picture)]


def obey(computer: ComputerWithCameras) -> None:
    for line in sys.stdin:
        word, number = line.split()
        getattr(computer, word)(int(number))


def run() -> int:
    count, rate, picture, topic = sys.argv[1:5]
    del sys.argv[1:5]
    with tempfile.TemporaryDirectory() as folder:
        computer = ComputerWithCameras(int(count), float(rate), picture, Path(folder))
        threading.Thread(target=obey, args=(computer,), daemon=True).start()
        if topic:  # subscribed to by the node's own connection to the master, once there is one
            threading.Thread(target=subscribe, args=(topic, computer), daemon=True).start()
        return main(computer.system())


def subscribe(topic: str, computer: ComputerWithCameras) -> None:
    while not rospy.core.is_initialized():
        threading.Event().wait(0.05)

    def take(message: CompressedImage) -> None:
        computer.feed(message.data)

    rospy.Subscriber(topic, CompressedImage, take, queue_size=1, buff_size=1 << 24)


if __name__ == "__main__":
    sys.exit(run())
