"""The choice of a camera among the devices of a computer, and explanations why none can be used. Pure."""

import errno
import os
from collections.abc import Sequence
from dataclasses import dataclass

from ur.devices.known import Device, DeviceSnapshot, describe_device
from ur.devices.needs import explain_access, explain_holder
from ur_nodes.camera.source import CameraError

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
        return _choose_path(snapshot, cameras, wanted)
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


def _choose_path(snapshot: DeviceSnapshot, cameras: Sequence[Device], wanted: str) -> CameraChoice:
    for device in cameras:
        if wanted in (device.path, *device.links):
            return CameraChoice("" if _is_ribbon(device) else device.path, 0, device)
    other = next((each for each in snapshot.devices if wanted in (each.path, *each.links)), None)
    if other:
        raise CameraError(f"{wanted} is no camera but {describe_device(other)}", _list_names(cameras), waits=False)
    return CameraChoice(wanted)


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
