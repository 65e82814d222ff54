"""A camera without hardware: it answers the ioctls of V4L2 as the kernel does, and can be unplugged or in use."""

from __future__ import annotations

import ctypes
import errno
import io
import os
import threading
import time
from collections import deque
from collections.abc import Mapping, Sequence
from typing import TypeVar

import numpy as np
from PIL import Image

from ur_nodes.camera import abi
from ur_nodes.pictures.decode import Pixels

Item = TypeVar("Item")
Sizes = Sequence[tuple[int, int]]
BUFFER_LENGTH = 1 << 20


def make_jpeg(width: int = 64, height: int = 48, colour: tuple[int, int, int] = (200, 40, 90)) -> bytes:
    """A picture whose left half has a colour and whose right half is black."""
    pixels = np.zeros((height, width, 3), np.uint8)
    pixels[:, : width // 2] = colour
    return encode(pixels)


def encode(pixels: Pixels) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "JPEG", quality=92)
    return file.getvalue()


class FakeCamera:
    """The hardware. `feed` is a picture that it takes; with `rate` and `film` it takes pictures by itself.

    With `patient` False nobody waits for a picture: for a bus, where time passes otherwise.
    """

    def __init__(
        self,
        formats: Mapping[str, Sizes] | None = None,
        *,
        name: str = "Fake Camera",
        controls: Mapping[int, tuple[int, int, int, int]] | None = None,
        rate: float = 0.0,
        film: Sequence[bytes] = (),
        patient: bool = True,
    ) -> None:
        self.formats = dict(formats or {"YUYV": [(640, 480)], "MJPG": [(640, 480), (320, 240)]})
        self.name = name
        self.controls = dict(controls or {})  # least, most, step, default
        self.values: dict[int, int] = {}
        self.rate, self.film = rate, film
        self.patient = patient
        self.plugged = True
        self.user: object = None  # the file that streams, or any other program
        self.changed = threading.Condition()
        self.pictures: deque[tuple[bytes, int]] = deque(maxlen=4)
        self.files: list[FakeFile] = []
        self.opened = 0
        self.capabilities = abi.CAP_VIDEO_CAPTURE | abi.CAP_STREAMING
        self.refuse: dict[int, int] = {}  # errno of requests that fail

    def open(self, path: str) -> FakeFile:
        if not self.plugged:
            raise OSError(errno.ENOENT, os.strerror(errno.ENOENT), path)
        self.opened += 1
        file = FakeFile(self)
        self.files.append(file)
        return file

    def feed(self, picture: bytes, flags: int = abi.BUF_MONOTONIC) -> None:
        with self.changed:
            self.pictures.append((picture, flags))
            self.changed.notify_all()

    def unplug(self) -> None:
        with self.changed:
            self.plugged, self.user = False, None
            self.pictures.clear()
            for file in self.files:
                file.gone = True
            self.changed.notify_all()

    def plug(self) -> None:
        with self.changed:
            self.plugged = True


class FakeFile:
    """An open file of the device."""

    def __init__(self, camera: FakeCamera) -> None:
        self._camera = camera
        self.gone = False
        self.closed = False
        self._format = abi.PixelFormat()
        self._memory: list[bytearray] = []
        self._queued: deque[int] = deque()
        self._due = 0.0
        self._count = 0

    def ioctl(self, request: int, argument: ctypes.Structure) -> None:
        self._check()
        if number := self._camera.refuse.get(request):
            raise OSError(number, os.strerror(number))
        answers = {
            abi.QUERYCAP: self._name,
            abi.ENUM_FMT: self._list_format,
            abi.ENUM_FRAMESIZES: self._list_size,
            abi.S_FMT: self._set_format,
            abi.S_PARM: self._set_rate,
            abi.QUERYCTRL: self._describe_control,
            abi.S_CTRL: self._set_control,
            abi.REQBUFS: self._allocate,
            abi.QUERYBUF: self._describe_buffer,
            abi.QBUF: self._queue,
            abi.DQBUF: self._dequeue,
            abi.STREAMON: self._stream,
            abi.STREAMOFF: self._stop,
        }
        if request not in answers:
            raise OSError(errno.ENOTTY, os.strerror(errno.ENOTTY))
        answers[request](argument)  # type: ignore[operator]  # each takes its own structure

    def wait(self, seconds: float) -> bool:
        camera = self._camera
        if camera.rate:
            self._film(seconds)
        with camera.changed:
            camera.changed.wait_for(lambda: camera.pictures or self.gone, seconds if camera.patient else 0.0)
            self._check()
            return bool(camera.pictures)

    def map(self, length: int, offset: int) -> memoryview:
        assert length == BUFFER_LENGTH
        return memoryview(self._memory[offset // BUFFER_LENGTH])

    def close(self) -> None:
        self.closed = True
        if self._camera.user is self:
            self._camera.user = None

    def _film(self, seconds: float) -> None:
        """Wait for the moment of the next picture, as an unhurried camera does."""
        now = time.monotonic()
        self._due = self._due or now
        left = self._due - now
        if left > seconds:
            time.sleep(seconds)
            return
        if left > 0.0:
            time.sleep(left)
        self._camera.feed(self._camera.film[self._count % len(self._camera.film)])
        self._count += 1
        self._due += 1.0 / self._camera.rate

    def _check(self) -> None:
        if self.closed:
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        if self.gone:
            raise OSError(errno.ENODEV, os.strerror(errno.ENODEV))

    def _name(self, found: abi.Capability) -> None:
        found.card, found.driver = self._camera.name.encode(), b"uvcvideo"
        found.capabilities = self._camera.capabilities | 0x00800000 | abi.CAP_DEVICE_CAPS
        found.device_caps = self._camera.capabilities

    def _list_format(self, found: abi.FormatDescription) -> None:
        names = list(self._camera.formats)
        found.pixelformat = abi.to_fourcc(pick(names, found.index))

    def _list_size(self, found: abi.FrameSize) -> None:
        sizes = self._camera.formats[abi.from_fourcc(found.pixel_format)]
        if len(sizes) == 3:  # least, most, step
            pick([0], found.index)
            found.type, size = 3, found.stepwise
            (size.min_width, size.min_height), (size.max_width, size.max_height) = sizes[0], sizes[1]
            size.step_width, size.step_height = sizes[2]
            return
        found.type = abi.SIZE_DISCRETE
        found.stepwise.min_width, found.stepwise.max_width = pick(list(sizes), found.index)

    def _set_format(self, found: abi.Format) -> None:
        if self._camera.user not in (None, self):
            raise OSError(errno.EBUSY, os.strerror(errno.EBUSY))
        fourcc, size = abi.from_fourcc(found.fmt.pix.pixelformat), (found.fmt.pix.width, found.fmt.pix.height)
        sizes = self._camera.formats[fourcc]
        if len(sizes) != 3 and size not in sizes:
            found.fmt.pix.width, found.fmt.pix.height = sizes[0]
        found.fmt.pix.bytesperline = {"YUYV": 2, "RGB3": 3}.get(fourcc, 0) * found.fmt.pix.width
        found.fmt.pix.sizeimage = BUFFER_LENGTH
        self._format = found.fmt.pix

    def _set_rate(self, found: abi.StreamParameters) -> None:
        found.parm.capture.capability = abi.PARM_TIMEPERFRAME
        found.parm.capture.numerator, found.parm.capture.denominator = 1, 30

    def _describe_control(self, found: abi.ControlQuery) -> None:
        if found.id not in self._camera.controls:
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))
        found.minimum, found.maximum, found.step, found.default_value = self._camera.controls[found.id]

    def _set_control(self, found: abi.Control) -> None:
        least, most, _, _ = self._camera.controls[found.id]
        if not least <= found.value <= most:
            raise OSError(errno.ERANGE, os.strerror(errno.ERANGE))
        self._camera.values[found.id] = found.value

    def _allocate(self, found: abi.BufferRequest) -> None:
        assert (found.type, found.memory) == (abi.CAPTURE, abi.MMAP)
        self._memory = [bytearray(BUFFER_LENGTH) for _ in range(found.count)]

    def _describe_buffer(self, found: abi.Buffer) -> None:
        pick(self._memory, found.index)
        found.length, found.m.offset = BUFFER_LENGTH, found.index * BUFFER_LENGTH

    def _queue(self, found: abi.Buffer) -> None:
        assert found.index not in self._queued, "a buffer was queued twice"
        self._queued.append(found.index)

    def _dequeue(self, found: abi.Buffer) -> None:
        assert self._camera.user is self, "not streaming"
        if not self._queued or not self._camera.pictures:
            raise OSError(errno.EAGAIN, os.strerror(errno.EAGAIN))
        picture, flags = self._camera.pictures.popleft()
        found.index = self._queued.popleft()
        self._memory[found.index][: len(picture)] = picture
        found.bytesused, found.flags = len(picture), flags
        now = time.monotonic()
        found.timestamp.seconds, found.timestamp.microseconds = int(now), int(now % 1.0 * 1e6)

    def _stream(self, _: abi.Integer) -> None:
        if self._camera.user not in (None, self):
            raise OSError(errno.EBUSY, os.strerror(errno.EBUSY))
        self._camera.user = self

    def _stop(self, _: abi.Integer) -> None:
        if self._camera.user is self:
            self._camera.user = None


def pick(items: Sequence[Item], index: int) -> Item:
    """As the kernel answers enumerations: EINVAL beyond the end."""
    if index >= len(items):
        raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))
    return items[index]
