"""An open V4L2 device: the calls that capture needs, behind a Protocol, and their implementation by the kernel."""

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
