"""Pictures of a V4L2 camera: its format is negotiated, its buffers are mapped, JPEG is passed on unchanged."""

import contextlib
import errno
import time
from collections.abc import Callable, Iterator

from ur.source.printable import printable
from ur_nodes.camera import abi
from ur_nodes.camera.abi import DeviceFile
from ur_nodes.camera.controls import apply_settings
from ur_nodes.camera.formats import (
    JPEG_FORMATS,
    RAW_FORMATS,
    OfferedFormat,
    SizeRange,
    choose_format,
    decode_jpeg,
    flip_pixels,
    trim_jpeg,
    unpack_raw,
)
from ur_nodes.camera.source import CameraError, CameraSettings, Frame, Mode
from ur_nodes.pictures.decode import BadPictureError

BUFFERS = 4
_MOST = 200  # formats, and sizes of each, that are listed
_LARGEST = 64 << 20  # bytes of a buffer


class V4l2Camera:
    """A PictureSource. Owns the device file; not for two threads at once."""

    def __init__(
        self, device: DeviceFile, path: str, settings: CameraSettings, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Negotiate a format and start streaming.

        Raises OSError with the kernel's errno (EBUSY: another program streams), or CameraError where the device is no
        camera or none of its formats can be used. The device is closed then.
        """
        self._device, self._path, self._settings, self._clock = device, path, settings, clock
        self._closed = False
        try:
            name = _read_name(device, path)
            self._format = _set_format(device, path, name, settings)
            rate = _set_rate(device, settings.rate)
            missing, self._mirror, self._flip = apply_settings(device, settings)
            request = abi.BufferRequest(count=BUFFERS, type=abi.CAPTURE, memory=abi.MMAP)
            device.ioctl(abi.REQBUFS, request)
            views = []
            for index in range(request.count):
                buffer = abi.Buffer(index=index, type=abi.CAPTURE, memory=abi.MMAP)
                device.ioctl(abi.QUERYBUF, buffer)
                if not 0 < buffer.length <= _LARGEST:
                    raise OSError(errno.EIO, "a buffer of an impossible length")
                views.append(device.map(buffer.length, buffer.m.offset))
                device.ioctl(abi.QBUF, abi.Buffer(index=index, type=abi.CAPTURE, memory=abi.MMAP))
            if not views:
                raise OSError(errno.ENOMEM, "no buffers")
            self._buffers = views
            device.ioctl(abi.STREAMON, abi.Integer(abi.CAPTURE))
        except BaseException:
            self.close()
            raise
        fourcc = abi.from_fourcc(self._format.pixelformat)
        self._jpeg = fourcc in JPEG_FORMATS
        passed_on = self._jpeg and not (self._mirror or self._flip)
        self._mode = Mode(name, path, self._format.width, self._format.height, rate, fourcc, passed_on, missing)

    @property
    def mode(self) -> Mode:
        return self._mode

    def read(self, seconds: float, *, wanted: bool = True) -> Frame | None:
        """See PictureSource. Damaged pictures are left out; of several waiting pictures the newest is returned."""
        try:
            newest: Frame | None = None
            while self._device.wait(seconds if newest is None else 0.0):
                frame = self._take(wanted=wanted)
                if frame is None and newest is None:
                    return None
                newest = frame or newest
            return newest
        except OSError as problem:
            if problem.errno == errno.EAGAIN:
                return None
            ended = "was unplugged" if problem.errno == errno.ENODEV else f"has failed: {problem.strerror}"
            raise CameraError(f"the camera {self._mode.camera} ({self._path}) {ended}") from None

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            with contextlib.suppress(OSError):  # the device may have been removed
                self._device.ioctl(abi.STREAMOFF, abi.Integer(abi.CAPTURE))
            self._device.close()

    def _take(self, *, wanted: bool) -> Frame | None:
        buffer = abi.Buffer(type=abi.CAPTURE, memory=abi.MMAP)
        self._device.ioctl(abi.DQBUF, buffer)
        view = self._buffers[buffer.index]
        good = not buffer.flags & abi.BUF_ERROR and 0 < buffer.bytesused <= len(view)
        age = self._age(buffer)
        data = bytes(view[: buffer.bytesused]) if good and wanted else b""
        self._device.ioctl(abi.QBUF, abi.Buffer(index=buffer.index, type=abi.CAPTURE, memory=abi.MMAP))
        if not good:
            return None
        return self._unpack(data, age) if wanted else Frame(age)

    def _unpack(self, data: bytes, age: float) -> Frame | None:
        if self._jpeg:
            jpeg = trim_jpeg(data)
            if jpeg is None or self._mode.passed_on:
                return Frame(age, jpeg) if jpeg else None
            try:
                pixels = decode_jpeg(jpeg)
            except BadPictureError:
                return None
        else:
            size = self._format
            found = unpack_raw(data, self._mode.format, size.width, size.height, size.bytesperline)
            if found is None:
                return None
            pixels = found
        if self._mirror or self._flip:
            pixels = flip_pixels(pixels, horizontally=self._mirror, vertically=self._flip)
        return Frame(age, pixels=pixels)

    def _age(self, buffer: abi.Buffer) -> float:
        if buffer.flags & abi.BUF_TIMESTAMP_MASK != abi.BUF_MONOTONIC:
            return 0.0
        age = self._clock() - (buffer.timestamp.seconds + buffer.timestamp.microseconds * 1e-6)
        return float(age) if 0.0 <= age < 1.0 else 0.0


def _read_name(device: DeviceFile, path: str) -> str:
    found = abi.Capability()
    try:
        device.ioctl(abi.QUERYCAP, found)
    except OSError as problem:
        if problem.errno != errno.ENOTTY:
            raise
        raise CameraError(f"{path} is no camera", "ur devices lists those of this computer", waits=False) from None
    abilities = found.device_caps if found.capabilities & abi.CAP_DEVICE_CAPS else found.capabilities
    name = printable(found.card.decode("utf-8", "replace").strip()) or "without a name"
    if not abilities & abi.CAP_VIDEO_CAPTURE or not abilities & abi.CAP_STREAMING:
        raise CameraError(
            f"{path} ({name}) takes no pictures",
            "a camera may have several devices: ur devices lists the right one",
            waits=False,
        )
    return name


def _list_formats(device: DeviceFile) -> Iterator[OfferedFormat]:
    for index in range(_MOST):
        found = abi.FormatDescription(index=index, type=abi.CAPTURE)
        if not _enumerate(device, abi.ENUM_FMT, found):
            return
        yield OfferedFormat(abi.from_fourcc(found.pixelformat), tuple(_list_sizes(device, found.pixelformat)))


def _list_sizes(device: DeviceFile, pixel_format: int) -> Iterator[SizeRange]:
    for index in range(_MOST):
        found = abi.FrameSize(index=index, pixel_format=pixel_format)
        if not _enumerate(device, abi.ENUM_FRAMESIZES, found):
            return
        size = found.stepwise
        if found.type != abi.SIZE_DISCRETE:
            yield SizeRange(
                (size.min_width, size.min_height),
                (size.max_width, size.max_height),
                (size.step_width, size.step_height),
            )
            return
        yield SizeRange((size.min_width, size.max_width), (size.min_width, size.max_width))


def _enumerate(device: DeviceFile, request: int, argument: abi.FormatDescription | abi.FrameSize) -> bool:
    try:
        device.ioctl(request, argument)
    except OSError as problem:
        if problem.errno in (errno.EINVAL, errno.ENOTTY):
            return False  # the end of the list
        raise
    return True


def _set_format(device: DeviceFile, path: str, name: str, settings: CameraSettings) -> abi.PixelFormat:
    offered = list(_list_formats(device))
    chosen = choose_format(offered, (settings.width, settings.height))
    if chosen is None:
        listed = ", ".join(each.fourcc for each in offered) or "no format"
        usable = ", ".join((*JPEG_FORMATS, *RAW_FORMATS))
        raise CameraError(
            f"the camera {name} ({path}) gives {printable(listed)}, expected one of {usable}",
            "a camera on the ribbon of a Raspberry Pi is read by libcamera: device:=libcamera",
            waits=False,
        )
    asked = abi.Format(type=abi.CAPTURE)
    asked.fmt.pix.pixelformat = abi.to_fourcc(chosen[0])
    asked.fmt.pix.width, asked.fmt.pix.height = chosen[1]
    asked.fmt.pix.field = 1  # V4L2_FIELD_NONE
    device.ioctl(abi.S_FMT, asked)
    got: abi.PixelFormat = asked.fmt.pix
    fourcc = abi.from_fourcc(got.pixelformat)
    if fourcc not in (*JPEG_FORMATS, *RAW_FORMATS) or not (0 < got.width <= 16384 and 0 < got.height <= 16384):
        raise CameraError(f"the camera {name} ({path}) gives {printable(fourcc)}, though it offered {chosen[0]}")
    return got


def _set_rate(device: DeviceFile, rate: float) -> float:
    """Set the rate, and return the one that the camera delivers; 0.0 if it is unknown."""
    asked = abi.StreamParameters(type=abi.CAPTURE)
    capture = asked.parm.capture
    capture.numerator, capture.denominator = 1000, max(1, round(rate * 1000.0))
    try:
        device.ioctl(abi.S_PARM, asked)
    except OSError as problem:
        if problem.errno in (errno.EINVAL, errno.ENOTTY):
            return 0.0
        raise
    reported = capture.capability & abi.PARM_TIMEPERFRAME and capture.numerator
    return capture.denominator / capture.numerator if reported else 0.0
