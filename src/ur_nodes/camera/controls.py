"""Controls of a V4L2 camera: mirroring, exposure, brightness and others."""

import errno

from ur_nodes.camera import abi
from ur_nodes.camera.abi import DeviceFile
from ur_nodes.camera.source import CameraSettings

# <linux/v4l2-controls.h>
BRIGHTNESS, CONTRAST, SATURATION, SHARPNESS = 0x00980900, 0x00980901, 0x00980902, 0x0098091B
MIRROR, FLIP = 0x00980914, 0x00980915
EXPOSURE_AUTO, EXPOSURE_ABSOLUTE, EXPOSURE_DYNAMIC_RATE = 0x009A0901, 0x009A0902, 0x009A0903
JPEG_QUALITY = 0x009D0903
_AUTOMATIC, _MANUAL, _APERTURE_PRIORITY = 0, 1, 3
_EXPOSURE_UNIT = 100  # microseconds


def apply_settings(device: DeviceFile, settings: CameraSettings) -> tuple[tuple[str, ...], bool, bool]:
    """Apply the settings for which the camera has controls.

    Returns the names of settings that it has none for, and whether pictures have to be mirrored horizontally and
    vertically here, because the camera does not. Raises OSError when the device was removed.
    """
    asked = settings.adjustments
    missing = []
    for name, control, value, symmetric in (
        ("brightness", BRIGHTNESS, asked.brightness, False),
        ("contrast", CONTRAST, asked.contrast, True),
        ("saturation", SATURATION, asked.saturation, True),
        ("sharpness", SHARPNESS, asked.sharpness, True),
    ):
        if value is not None and not _scale_control(device, control, value, symmetric=symmetric):
            missing.append(name)
    if asked.shutter_speed is not None and not _set_exposure(device, asked.shutter_speed) and asked.shutter_speed:
        missing.append("shutter_speed")
    _set_control(device, EXPOSURE_DYNAMIC_RATE, 0)  # else the rate falls to half in a dim room
    _set_control(device, JPEG_QUALITY, settings.quality)
    mirrored = _set_control(device, MIRROR, int(settings.flip_horizontally))
    flipped = _set_control(device, FLIP, int(settings.flip_vertically))
    return tuple(missing), settings.flip_horizontally and not mirrored, settings.flip_vertically and not flipped


def scale_value(value: int, query: abi.ControlQuery, *, symmetric: bool) -> int:
    """Convert a value from raspicam_node's scale (0 to 100, or -100 to 100 if symmetric) to that of the camera.

    The middle of the scale is the camera's default.
    """
    share = value / 100.0 if symmetric else value / 50.0 - 1.0
    default, edge = query.default_value, query.maximum if share > 0.0 else query.minimum
    scaled = default + abs(share) * (edge - default)
    step = max(1, query.step)
    whole = query.minimum + round((scaled - query.minimum) / step) * step
    return int(min(max(whole, query.minimum), query.maximum))


def _set_exposure(device: DeviceFile, shutter_speed: int) -> bool:
    if shutter_speed == 0:
        return _set_control(device, EXPOSURE_AUTO, _APERTURE_PRIORITY) or _set_control(
            device, EXPOSURE_AUTO, _AUTOMATIC
        )
    manual = _set_control(device, EXPOSURE_AUTO, _MANUAL)
    query = _query(device, EXPOSURE_ABSOLUTE, inactive=True)
    if not manual or query is None:
        return False
    value = min(max(round(shutter_speed / _EXPOSURE_UNIT), query.minimum, 1), query.maximum)
    return _set_control(device, EXPOSURE_ABSOLUTE, value)


def _scale_control(device: DeviceFile, control: int, value: int, *, symmetric: bool) -> bool:
    query = _query(device, control)
    return query is not None and _set_control(device, control, scale_value(value, query, symmetric=symmetric))


def _set_control(device: DeviceFile, control: int, value: int) -> bool:
    if _query(device, control, inactive=True) is None:
        return False
    try:
        device.ioctl(abi.S_CTRL, abi.Control(id=control, value=value))
    except OSError as problem:
        return _absent(problem)
    return True


def _query(device: DeviceFile, control: int, *, inactive: bool = False) -> abi.ControlQuery | None:
    query = abi.ControlQuery(id=control)
    try:
        device.ioctl(abi.QUERYCTRL, query)
    except OSError as problem:
        _absent(problem)
        return None
    unusable = abi.CONTROL_DISABLED | abi.CONTROL_READ_ONLY | (0 if inactive else abi.CONTROL_INACTIVE)
    return None if query.flags & unusable else query


def _absent(problem: OSError) -> bool:
    """Return False for a control that is absent; raise if the device was removed."""
    if problem.errno == errno.ENODEV:
        raise problem
    return False
