"""Opens the requested camera or explains why none can be used, and finds it again after it was unplugged."""

import errno
import os
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.devices.known import Device, DeviceSnapshot, describe_device
from ur.devices.needs import explain_access, explain_holder
from ur.devices.observe import device_script, parse_devices
from ur_nodes.camera.abi import KernelDeviceFile, OpenDevice
from ur_nodes.camera.capture import V4l2Camera
from ur_nodes.camera.libcamera import LibcameraCamera
from ur_nodes.camera.source import CameraError, CameraSettings, PictureSource

LIBCAMERA = "libcamera"
# Receivers of a Raspberry Pi's camera connector, by driver or name: what they give is raw and needs libcamera.
_RIBBON = ("unicam", "rp1-cfe")


@dataclass(frozen=True, slots=True)
class CameraChoice:
    """A camera that was found. `path` is its device file, or '' for the camera `number` of libcamera.

    `device` is None where nothing more is known about it.
    """

    path: str
    number: int = 0
    device: Device | None = None


def choose_camera(snapshot: DeviceSnapshot, wanted: str, number: int, *, raspberry: bool) -> CameraChoice:
    """Choose the camera that a user wants.

    `wanted` is a path, `libcamera`, part of a name or serial number as `ur devices` lists them, or '' for any;
    `number` counts them from 0. `raspberry`: the computer is a Raspberry Pi. Where any will do, the camera
    on its ribbon is preferred. Raises CameraError where there is none.
    """
    cameras = [each for each in snapshot.devices if each.kind == "camera"]
    ribbon = [each for each in cameras if _is_ribbon(each)]
    own = [each for each in cameras if not _is_ribbon(each)]
    if wanted == LIBCAMERA or (not wanted and ribbon):
        return CameraChoice("", number, ribbon[0] if ribbon else None)
    if wanted.startswith("/"):
        for device in cameras:
            if wanted in (device.path, *device.links):
                return CameraChoice("" if _is_ribbon(device) else device.path, 0, device)
        other = next((each for each in snapshot.devices if wanted in (each.path, *each.links)), None)
        if other:
            raise CameraError(f"{wanted} is no camera but {describe_device(other)}", _list_names(cameras), waits=False)
        return CameraChoice(wanted)
    fitting = [each for each in own if not wanted or wanted.casefold() in _names(each)]
    if number < len(fitting):
        return CameraChoice(fitting[number].path, number, fitting[number])
    raise CameraError(_describe_absence(own, wanted, number), _suggest(snapshot, own, raspberry=raspberry))


def explain_failure(snapshot: DeviceSnapshot, path: str, problem: OSError) -> CameraError:
    """Explain why a device cannot be opened or does not stream."""
    device = next((each for each in snapshot.devices if path in (each.path, *each.links)), None)
    name = f"the camera {path}" + (f" ({describe_device(device)})" if device else "")
    if problem.errno in (errno.ENOENT, errno.ENODEV, errno.ENXIO):
        return CameraError(f"{name} is not there", "plug it in; this node goes on by itself")
    if problem.errno in (errno.EACCES, errno.EPERM):
        help = explain_access(snapshot, device) if device else "ur devices says who may open it"
        return CameraError(f"{snapshot.user or 'this user'} may not open {name}", help)
    if problem.errno == errno.EBUSY:
        if device and any(each.pid != os.getpid() for each in device.holders):
            holder = device.holders[0]
            return CameraError(f"{name} is in use by {holder.program}, process {holder.pid}", explain_holder(device))
        return CameraError(f"{name} is in use by another program", "sudo fuser -v " + path + " names it")
    if problem.errno == errno.ENOSPC:
        return CameraError(
            f"{name} gets no room on its USB bus, which other cameras use",
            "plug it into another port of the computer, not into the same hub, or ask for a smaller picture or rate",
        )
    return CameraError(f"{name} cannot be used: {problem.strerror or problem}", "unplug it and plug it in again")


def describe_choice(choice: CameraChoice) -> str:
    """Describe the camera in a few words for a log."""
    if choice.device is None:
        return choice.path or f"camera {choice.number} of libcamera"
    number = f", number {choice.device.serial}" if choice.device.serial else ""
    usb = f", USB {choice.device.usb}{number}" if choice.device.usb else ""
    return f"{describe_device(choice.device)} ({choice.path or 'libcamera'}{usb})"


def _is_ribbon(device: Device) -> bool:
    return any(word in text.casefold() for text in (device.driver, device.product) for word in _RIBBON)


def _names(device: Device) -> str:
    return " ".join((device.path, *device.links, device.manufacturer, device.product, device.serial)).casefold()


def _list_names(cameras: Sequence[Device]) -> str:
    if not cameras:
        return "no camera is there: ur devices lists what is"
    return "cameras: " + ", ".join(f"{each.path} ({describe_device(each)})" for each in cameras)


def _describe_absence(cameras: Sequence[Device], wanted: str, number: int) -> str:
    which = f"with {wanted!r} in its name " if wanted else ""
    if number and cameras:
        return f"no camera {number} {which}is there, counted from 0"
    return f"no camera {which}is there: looked for USB cameras (/dev/video*) and cameras on a ribbon (libcamera)"


def _suggest(snapshot: DeviceSnapshot, cameras: Sequence[Device], *, raspberry: bool) -> str:
    if cameras:
        return _list_names(cameras)
    if snapshot.container:
        return "this is a container: it shows only the devices that its host passes on"
    if not raspberry:
        return "plug a USB camera in; this node goes on by itself"
    return (
        "USB: plug it in. Ribbon: switch off, check both ends of it and the side of its contacts; then"
        " camera_auto_detect=1, or dtoverlay=imx219 for a camera v2, in /boot/firmware/config.txt, and restart"
    )


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
            try:
                source = V4l2Camera(self._system.open_device(choice.path), choice.path, self._settings)
            except OSError as problem:
                raise explain_failure(self._snapshot, choice.path, problem) from None
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

    def _inspect(self) -> None:
        # List the device files of cameras, with attributes that show a new device or changed permissions
        found = []
        for path in sorted(self._system.devices.glob("video*")):
            try:
                state = path.stat()
            except OSError:
                continue
            found.append((path.name, state.st_ino, state.st_ctime_ns))
        now, files = self._system.clock(), found
        if self._inspected and self._inspected[1] == files and now - self._inspected[0] < _INSPECT_EVERY:
            return
        self._snapshot = self._system.inspect()
        self._inspected = (now, files)


def _is_same(device: Device, own: Device) -> bool:
    if (device.usb, device.serial) != (own.usb, own.serial):
        return False
    return bool(own.serial) or device.port == own.port
