"""Joysticks without hardware: a uinput device where the kernel has uinput, or a named pipe that speaks the same format.

Either has an xbox pad's first axes (x, y of the left stick) and eight buttons, numbered as the driver xpad does.
"""

import fcntl
import os
import struct
import time
from pathlib import Path

from ur_nodes.motion.joystick.device import RECORD

UINPUT = Path("/dev/uinput")
_EV_SYN, _EV_KEY, _EV_ABS = 0, 1, 3
_BUTTONS = (0x130, 0x131, 0x133, 0x134, 0x136, 0x137, 0x13A, 0x13B)  # south, east, north, west, TL, TR, select, start
# Requests and structures of linux/uinput.h
_SET_EVBIT, _SET_KEYBIT, _SET_ABSBIT = 0x40045564, 0x40045565, 0x40045567
_DEV_SETUP, _ABS_SETUP, _DEV_CREATE, _DEV_DESTROY = 0x405C5503, 0x401C5504, 0x5501, 0x5502


class PipeJoystick:
    """A named pipe in the place of /dev/input/js0."""

    def __init__(self, path: Path) -> None:
        self.device = str(path)
        os.mkfifo(path)
        self.plug()

    def plug(self) -> None:
        self._pipe = os.open(self.device, os.O_RDWR)  # so that neither side waits for the other
        for kind, count in ((2, 2), (1, 8)):
            for number in range(count):
                self._write(kind | 0x80, number, 0)

    def press(self, button: int, pressed: bool) -> None:
        self._write(1, button, int(pressed))

    def push(self, axis: int, value: int) -> None:
        """`value` is raw: -32767 is up or left."""
        self._write(2, axis, value)

    def close(self) -> None:
        os.close(self._pipe)

    def _write(self, kind: int, number: int, value: int) -> None:
        os.write(self._pipe, RECORD.pack(0, value, kind, number))


class UinputJoystick:
    """A device that the kernel makes."""

    def __init__(self) -> None:
        before = set(Path("/dev/input").glob("js*"))
        self._uinput = os.open(UINPUT, os.O_WRONLY)
        for kind in (_EV_KEY, _EV_ABS):
            fcntl.ioctl(self._uinput, _SET_EVBIT, kind)
        for button in _BUTTONS:
            fcntl.ioctl(self._uinput, _SET_KEYBIT, button)
        for axis in (0, 1):
            fcntl.ioctl(self._uinput, _SET_ABSBIT, axis)
            fcntl.ioctl(self._uinput, _ABS_SETUP, struct.pack("=HH6i", axis, 0, 0, -32767, 32767, 0, 0, 0))
        name = b"test joystick"
        fcntl.ioctl(self._uinput, _DEV_SETUP, struct.pack("=4H80sI", 3, 1, 1, 1, name, 0))
        fcntl.ioctl(self._uinput, _DEV_CREATE)
        end = time.monotonic() + 5.0
        while not (made := set(Path("/dev/input").glob("js*")) - before):
            assert time.monotonic() < end, "uinput made no joystick: is the kernel's joydev there?"
            time.sleep(0.02)
        self.device = str(made.pop())

    def press(self, button: int, pressed: bool) -> None:
        self._write(_EV_KEY, _BUTTONS[button], int(pressed))

    def push(self, axis: int, value: int) -> None:
        self._write(_EV_ABS, axis, value)

    def close(self) -> None:
        fcntl.ioctl(self._uinput, _DEV_DESTROY)
        os.close(self._uinput)

    def _write(self, kind: int, code: int, value: int) -> None:
        os.write(self._uinput, struct.pack("llHHi", 0, 0, kind, code, value))
        os.write(self._uinput, struct.pack("llHHi", 0, 0, _EV_SYN, 0, 0))


VirtualJoystick = PipeJoystick | UinputJoystick
