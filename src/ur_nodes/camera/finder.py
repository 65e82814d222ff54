"""Opens the requested camera, and finds it again after it was unplugged."""

import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.devices.known import Device, DeviceSnapshot
from ur.devices.observe import device_script, parse_devices
from ur_nodes.camera.capture import V4l2Camera
from ur_nodes.camera.choice import CameraChoice, choose_camera, describe_choice, explain_failure
from ur_nodes.camera.device_file import KernelDeviceFile, OpenDevice
from ur_nodes.camera.libcamera import LibcameraCamera
from ur_nodes.camera.source import CameraError, CameraSettings, PictureSource

_INSPECT_EVERY = 10.0  # s, while the device files are the same
_SECONDS = 20.0  # that an inspection may take
_MODEL = Path("/proc/device-tree/model")


def inspect_cameras() -> DeviceSnapshot:
    """Inspect the devices of this computer; an empty snapshot where that fails."""
    try:
        done = subprocess.run(
            ["sh", "-c", device_script()],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return DeviceSnapshot()
    return parse_devices(done.stdout)


def is_raspberry() -> bool:
    """Return whether this computer is a Raspberry Pi."""
    try:
        return "Raspberry Pi" in _MODEL.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False


@dataclass(frozen=True, slots=True)
class FinderSystem:
    """The parts of the computer that a finder needs; tests replace some of them."""

    open_device: OpenDevice = KernelDeviceFile
    open_libcamera: Callable[[int, CameraSettings], PictureSource] = LibcameraCamera
    inspect: Callable[[], DeviceSnapshot] = inspect_cameras
    is_raspberry: Callable[[], bool] = is_raspberry
    clock: Callable[[], float] = time.monotonic
    devices: Path = Path("/dev")


class CameraFinder:
    """Opens one camera. Once it has been open, only the same camera is opened again, at any port."""

    def __init__(
        self, settings: CameraSettings, wanted: str = "", number: int = 0, system: FinderSystem | None = None
    ) -> None:
        """For `wanted` and `number` see `choose_camera`."""
        self._settings, self._wanted, self._number = settings, wanted, number
        self._system = system or FinderSystem()
        self._snapshot = DeviceSnapshot()
        self._inspected: tuple[float, object] | None = None
        self._own: Device | None = None
        self.description = ""

    def open(self) -> PictureSource:
        """Open the camera; `description` names it then. Raises CameraError, which explains why that is not possible."""
        self._inspect()
        choice = self._choose()
        if not choice.path:
            source = self._system.open_libcamera(choice.number, self._settings)
        else:
            source = self._open_device(choice)
        self._own = choice.device
        self.description = describe_choice(choice)
        return source

    def _choose(self) -> CameraChoice:
        own = self._own
        if own is None or not own.usb or self._wanted.startswith("/"):
            return choose_camera(self._snapshot, self._wanted, self._number, raspberry=self._system.is_raspberry())
        for device in self._snapshot.devices:
            if device.kind == "camera" and _is_same(device, own):
                return CameraChoice(device.path, self._number, device)
        raise CameraError(
            f"the camera {describe_choice(CameraChoice(own.path, 0, own))} was unplugged",
            "plug it in; this node goes on by itself. For another camera start the node again",
        )

    def _open_device(self, choice: CameraChoice) -> PictureSource:
        try:
            return V4l2Camera(self._system.open_device(choice.path), choice.path, self._settings)
        except OSError as problem:
            raise explain_failure(self._snapshot, choice.path, problem) from None

    def _inspect(self) -> None:
        now, files = self._system.clock(), _list_files(self._system.devices)
        if self._inspected and self._inspected[1] == files and now - self._inspected[0] < _INSPECT_EVERY:
            return
        self._snapshot = self._system.inspect()
        self._inspected = (now, files)


def _is_same(device: Device, own: Device) -> bool:
    if (device.usb, device.serial) != (own.usb, own.serial):
        return False
    return bool(own.serial) or device.port == own.port


def _list_files(folder: Path) -> Sequence[tuple[str, int, int]]:
    """List the device files of cameras, with attributes that show a new device or changed permissions."""
    found = []
    for path in sorted(folder.glob("video*")):
        try:
            state = path.stat()
        except OSError:
            continue
        found.append((path.name, state.st_ino, state.st_ctime_ns))
    return found
