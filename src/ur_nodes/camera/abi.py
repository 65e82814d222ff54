"""Structures, numbers and calls of V4L2, as <linux/videodev2.h> defines them; a test compares them with the header.

Only the single-planar API with memory mapping, which USB cameras have.
"""

import ctypes
import errno
import fcntl
import mmap
import os
import select
from collections.abc import Callable
from typing import Protocol


class DeviceFile(Protocol):
    """Each call raises OSError with the errno that the kernel gives; ENODEV when the device was unplugged."""

    def ioctl(self, request: int, argument: ctypes.Structure) -> None:
        """Perform an ioctl; the kernel's answer is written into the argument."""

    def wait(self, seconds: float) -> bool:
        """Wait until a buffer can be dequeued; False after that time. Raises OSError when the device was removed."""

    def map(self, length: int, offset: int) -> memoryview:
        """Map a buffer of the device. It is valid until `close`."""

    def close(self) -> None:
        """Release the device and everything mapped. May be called twice."""


OpenDevice = Callable[[str], DeviceFile]


class KernelDeviceFile:
    """A device of this computer's kernel."""

    def __init__(self, path: str) -> None:
        """Raises OSError."""
        self._file = os.open(path, os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)
        self._maps: list[tuple[mmap.mmap, memoryview]] = []
        self._poll = select.poll()
        self._poll.register(self._file, select.POLLIN)

    def ioctl(self, request: int, argument: ctypes.Structure) -> None:
        while True:
            try:
                fcntl.ioctl(self._file, request, argument, True)
            except InterruptedError:
                continue
            return

    def wait(self, seconds: float) -> bool:
        """See DeviceFile. poll reports an unplugged device, and one whose streaming has stopped, as an error."""
        events = self._poll.poll(seconds * 1000.0)
        if any(event & (select.POLLERR | select.POLLHUP | select.POLLNVAL) for _, event in events):
            raise OSError(errno.ENODEV, os.strerror(errno.ENODEV))
        return bool(events)

    def map(self, length: int, offset: int) -> memoryview:
        mapped = mmap.mmap(self._file, length, mmap.MAP_SHARED, mmap.PROT_READ | mmap.PROT_WRITE, offset=offset)
        view = memoryview(mapped)
        self._maps.append((mapped, view))
        return view

    def close(self) -> None:
        for mapped, view in self._maps:
            view.release()
            mapped.close()
        self._maps = []
        if self._file >= 0:
            os.close(self._file)
            self._file = -1


_U8, _U32, _S32 = ctypes.c_uint8, ctypes.c_uint32, ctypes.c_int32

CAPTURE = 1  # V4L2_BUF_TYPE_VIDEO_CAPTURE
MMAP = 1  # V4L2_MEMORY_MMAP
CAP_VIDEO_CAPTURE, CAP_STREAMING, CAP_DEVICE_CAPS = 0x1, 0x04000000, 0x80000000
SIZE_DISCRETE = 1  # V4L2_FRMSIZE_TYPE_DISCRETE
BUF_ERROR, BUF_MONOTONIC, BUF_TIMESTAMP_MASK = 0x40, 0x2000, 0xE000
CONTROL_DISABLED, CONTROL_READ_ONLY, CONTROL_INACTIVE = 0x1, 0x4, 0x10
PARM_TIMEPERFRAME = 0x1000  # V4L2_CAP_TIMEPERFRAME


class Capability(ctypes.Structure):
    """struct v4l2_capability."""

    _fields_ = [
        ("driver", ctypes.c_char * 16),
        ("card", ctypes.c_char * 32),
        ("bus_info", ctypes.c_char * 32),
        ("version", _U32),
        ("capabilities", _U32),
        ("device_caps", _U32),
        ("reserved", _U32 * 3),
    ]


class FormatDescription(ctypes.Structure):
    """struct v4l2_fmtdesc."""

    _fields_ = [
        ("index", _U32),
        ("type", _U32),
        ("flags", _U32),
        ("description", ctypes.c_char * 32),
        ("pixelformat", _U32),
        ("mbus_code", _U32),
        ("reserved", _U32 * 3),
    ]


class _Stepwise(ctypes.Structure):
    _fields_ = [(name, _U32) for name in ("min_width", "max_width", "step_width")] + [
        (name, _U32) for name in ("min_height", "max_height", "step_height")
    ]


class FrameSize(ctypes.Structure):
    """struct v4l2_frmsizeenum; of type SIZE_DISCRETE the size is in min_width and max_width, which share its memory."""

    _fields_ = [
        ("index", _U32),
        ("pixel_format", _U32),
        ("type", _U32),
        ("stepwise", _Stepwise),
        ("reserved", _U32 * 2),
    ]


class PixelFormat(ctypes.Structure):
    """struct v4l2_pix_format."""

    _fields_ = [
        (name, _U32)
        for name in ("width", "height", "pixelformat", "field", "bytesperline", "sizeimage", "colorspace", "priv")
    ] + [(name, _U32) for name in ("flags", "ycbcr_enc", "quantization", "xfer_func")]


class _FormatUnion(ctypes.Union):
    # The pointers in other members of the kernel's union align it.
    _fields_ = [("pix", PixelFormat), ("raw_data", _U8 * 200), ("_align", ctypes.c_void_p)]


class Format(ctypes.Structure):
    """struct v4l2_format."""

    _fields_ = [("type", _U32), ("fmt", _FormatUnion)]


class CaptureParameters(ctypes.Structure):
    """struct v4l2_captureparm, with the fraction `timeperframe` in place."""

    _fields_ = [
        (name, _U32)
        for name in ("capability", "capturemode", "numerator", "denominator", "extendedmode", "readbuffers")
    ] + [("reserved", _U32 * 4)]


class _ParametersUnion(ctypes.Union):
    _fields_ = [("capture", CaptureParameters), ("raw_data", _U8 * 200)]


class StreamParameters(ctypes.Structure):
    """struct v4l2_streamparm."""

    _fields_ = [("type", _U32), ("parm", _ParametersUnion)]


class BufferRequest(ctypes.Structure):
    """struct v4l2_requestbuffers."""

    _fields_ = [
        ("count", _U32),
        ("type", _U32),
        ("memory", _U32),
        ("capabilities", _U32),
        ("flags", _U8),
        ("reserved", _U8 * 3),
    ]


class _Time(ctypes.Structure):
    _fields_ = [("seconds", ctypes.c_long), ("microseconds", ctypes.c_long)]


class _Timecode(ctypes.Structure):
    _fields_ = [("type", _U32), ("flags", _U32), ("numbers", _U8 * 8)]


class _Memory(ctypes.Union):
    _fields_ = [("offset", _U32), ("userptr", ctypes.c_ulong)]


class Buffer(ctypes.Structure):
    """struct v4l2_buffer."""

    _fields_ = [
        ("index", _U32),
        ("type", _U32),
        ("bytesused", _U32),
        ("flags", _U32),
        ("field", _U32),
        ("timestamp", _Time),
        ("timecode", _Timecode),
        ("sequence", _U32),
        ("memory", _U32),
        ("m", _Memory),
        ("length", _U32),
        ("reserved2", _U32),
        ("request_fd", _S32),
    ]


class Control(ctypes.Structure):
    """struct v4l2_control."""

    _fields_ = [("id", _U32), ("value", _S32)]


class ControlQuery(ctypes.Structure):
    """struct v4l2_queryctrl."""

    _fields_ = [
        ("id", _U32),
        ("type", _U32),
        ("name", ctypes.c_char * 32),
        ("minimum", _S32),
        ("maximum", _S32),
        ("step", _S32),
        ("default_value", _S32),
        ("flags", _U32),
        ("reserved", _U32 * 2),
    ]


class Integer(ctypes.Structure):
    """The int that VIDIOC_STREAMON and VIDIOC_STREAMOFF take."""

    _fields_ = [("value", ctypes.c_int)]


def _number(direction: int, number: int, kind: type[ctypes.Structure]) -> int:
    # _IOC of <asm-generic/ioctl.h>; x86, ARM and RISC-V have it.
    return direction << 30 | ctypes.sizeof(kind) << 16 | ord("V") << 8 | number


_WRITE, _READ = 1, 2
QUERYCAP = _number(_READ, 0, Capability)
ENUM_FMT = _number(_READ | _WRITE, 2, FormatDescription)
S_FMT = _number(_READ | _WRITE, 5, Format)
REQBUFS = _number(_READ | _WRITE, 8, BufferRequest)
QUERYBUF = _number(_READ | _WRITE, 9, Buffer)
QBUF = _number(_READ | _WRITE, 15, Buffer)
DQBUF = _number(_READ | _WRITE, 17, Buffer)
STREAMON = _number(_WRITE, 18, Integer)
STREAMOFF = _number(_WRITE, 19, Integer)
S_PARM = _number(_READ | _WRITE, 22, StreamParameters)
S_CTRL = _number(_READ | _WRITE, 28, Control)
QUERYCTRL = _number(_READ | _WRITE, 36, ControlQuery)
ENUM_FRAMESIZES = _number(_READ | _WRITE, 74, FrameSize)


def to_fourcc(text: str) -> int:
    """The number of a pixel format of four characters."""
    return int.from_bytes(text.encode("ascii"), "little")


def from_fourcc(number: int) -> str:
    """The four characters of a pixel format; other bytes than printable ones become question marks."""
    return "".join(chr(each) if 32 <= each < 127 else "?" for each in (number & 0x7FFFFFFF).to_bytes(4, "little"))
