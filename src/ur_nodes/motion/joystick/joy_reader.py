"""Reading of a joystick: its device is opened again when it was removed, and each change is published as `joy`."""

import errno
import os
import select
from functools import partial
from typing import Protocol

from ur_nodes.motion.joystick.device import RECORD, JoystickSettings, JoystickState, apply_records, let_go
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Joystick

_RETRY = 1.0  # s
_LONGEST_READ = 0.5  # s
_LAST_WORDS, _PAUSE = 3, 0.02  # s
_LANE = "device"


class JoystickDevice(Protocol):
    """A joystick's device. Calls may wait, none overlaps another."""

    path: str

    def open(self) -> str:
        """Open the device, or return why that fails."""

    def read(self, wait: float) -> bytes | None:
        """Return the available data, after at most `wait` s; None, and closed, if the device was removed."""


class FileDevice:
    """A device of the kernel, such as /dev/input/js0."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._file = -1

    def open(self) -> str:
        try:
            self._file = os.open(self.path, os.O_RDONLY | os.O_NONBLOCK)
        except OSError as problem:
            hint = "; add yourself to the group that owns it (input)" if problem.errno == errno.EACCES else ""
            return f"{str(problem.strerror).lower()}, expected a joystick; waiting for one{hint}"
        return ""

    def read(self, wait: float) -> bytes | None:
        if not select.select([self._file], [], [], wait)[0]:
            return b""
        try:
            data = os.read(self._file, 64 * RECORD.size)
        except BlockingIOError:
            return b""
        except OSError:
            data = b""
        if not data:
            os.close(self._file)
        return data or None


class JoyReader:
    """Publishes a device's state at each change, and again after a silence of `repeat` s."""

    def __init__(
        self, node: Node, device: JoystickDevice, settings: JoystickSettings, repeat: float, gather: float
    ) -> None:
        """`gather` (s) is how long changes wait for others."""
        self._node, self._device, self._settings = node, device, settings
        self._repeat, self._gather = repeat, gather
        self._publisher = node.publish("joy", Joystick)
        self._logged = ""
        self._state, self._rest, self._due = JoystickState(), b"", 0.0
        self._open()

    def _open(self) -> None:
        self._node.work(self._device.open, self._on_opened, _LANE)

    def _on_opened(self, problem: str) -> None:
        if problem:
            if problem != self._logged:
                self._node.log.warn(f"{self._device.path}: {problem}")
            self._logged = problem
            self._node.after(_RETRY, self._open, steady=True)
            return
        self._logged = ""
        self._node.log.info(f"{self._device.path}: joystick found")
        self._state, self._rest = JoystickState(), b""
        self._due = self._node.steady() + self._repeat
        self._read()

    def _read(self) -> None:
        wait = max(0.0, min(self._due - self._node.steady(), _LONGEST_READ))
        self._node.work(partial(self._device.read, wait), self._on_data, _LANE)

    def _on_data(self, data: bytes | None) -> None:
        if data is None:
            self._let_go()
            return
        self._state, event, self._rest = apply_records(self._state, self._rest + data, self._settings)
        if event or self._node.steady() >= self._due:
            self._publish(self._state)
        if data:
            self._node.after(self._gather, self._read, steady=True)
        else:
            self._read()

    def _let_go(self) -> None:
        """Release all buttons after the device was removed, and stop publishing."""
        self._node.log.warn(f"{self._device.path}: the joystick was unplugged; waiting for it")
        for number in range(_LAST_WORDS):
            self._node.after(number * _PAUSE, partial(self._publish, let_go(self._state)), steady=True)
        self._node.after(_RETRY, self._open, steady=True)

    def _publish(self, state: JoystickState) -> None:
        self._publisher.send(Joystick(self._node.now(), state.axes, state.buttons))
        self._due = self._node.steady() + self._repeat
