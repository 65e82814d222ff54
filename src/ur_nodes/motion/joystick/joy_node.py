"""Read a joystick: the stand-in for joy_node. Publishes `joy` on every change, and again at the autorepeat rate."""

from __future__ import annotations

import errno
import os
import select
import sys
import threading
import time

import rospy
from sensor_msgs.msg import Joy

from ur_nodes.motion.joystick.device import RECORD, JoystickSettings, JoystickState, let_go, take_records
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.shell import run_node

_RETRY = 1.0  # s
_LAST_WORDS = 3


class JoyNode:
    """Opens the device, and again when it is gone, in a thread of its own."""

    def __init__(self, device: str, settings: JoystickSettings, repeat: float, gather: float) -> None:
        """`repeat` is the longest silence while the device is there, `gather` how long changes wait for others: s."""
        self._device = device
        self._settings = settings
        self._repeat = repeat
        self._gather = gather
        self._publisher = rospy.Publisher("joy", Joy, queue_size=1, tcp_nodelay=True)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="joystick", daemon=True)
        rospy.on_shutdown(self._end)
        self._thread.start()

    def _end(self) -> None:
        self._ended.set()
        self._thread.join(timeout=1.0)

    def _run(self) -> None:
        logged = ""
        while not self._ended.is_set():
            try:
                descriptor = os.open(self._device, os.O_RDONLY | os.O_NONBLOCK)
            except OSError as problem:
                if problem.strerror != logged:
                    logged = str(problem.strerror)
                    rospy.logwarn(
                        "%s: %s, expected a joystick; waiting for one%s", self._device, logged.lower(), _hint(problem)
                    )
                self._ended.wait(_RETRY)
                continue
            logged = ""
            rospy.loginfo("%s: joystick found", self._device)
            try:
                self._read(descriptor)
            finally:
                os.close(descriptor)
            self._ended.wait(_RETRY)

    def _read(self, descriptor: int) -> None:
        """Publish until the device is gone; then all buttons count as released, and nothing is published."""
        state, rest = JoystickState(), b""
        due = time.monotonic() + self._repeat
        while not self._ended.is_set():
            wait = max(0.0, min(due - time.monotonic(), 0.5))
            if not select.select([descriptor], [], [], wait)[0]:
                if time.monotonic() >= due:
                    self._publish(state)
                    due = time.monotonic() + self._repeat
                continue
            data = _read_some(descriptor)
            if data is None:
                break
            state, event, rest = take_records(state, rest + data, self._settings)
            if event:
                self._publish(state)
                due = time.monotonic() + self._repeat
            self._ended.wait(self._gather)
        else:
            return
        rospy.logwarn("%s: the joystick is gone; waiting for it", self._device)
        for _ in range(_LAST_WORDS):
            self._publish(let_go(state))
            self._ended.wait(0.02)

    def _publish(self, state: JoystickState) -> None:
        message = Joy(axes=list(state.axes), buttons=list(state.buttons))
        message.header.stamp = rospy.Time.now()
        self._publisher.publish(message)


def _read_some(descriptor: int) -> bytes | None:
    """Return the bytes that are available; None at the end of the device."""
    try:
        return os.read(descriptor, 64 * RECORD.size) or None
    except BlockingIOError:
        return b""
    except OSError:
        return None


def _hint(problem: OSError) -> str:
    return "; add yourself to the group that owns it (input)" if problem.errno == errno.EACCES else ""


def start() -> None:
    """Read the parameters and run. Raises UserError."""
    own = Parameters()
    rate = own.number("autorepeat_rate", 0.0, minimum=0.0, maximum=200.0)
    JoyNode(
        own.text("dev", "/dev/input/js0"),
        JoystickSettings(own.number("deadzone", 0.05, minimum=0.0, maximum=0.9), own.boolean("sticky_buttons", False)),
        1.0 / rate if rate else float("inf"),
        own.number("coalesce_interval", 0.001, minimum=0.0, maximum=0.1),
    )


def main() -> int:
    """Run until shutdown. Returns the exit code."""
    return run_node("joy_node", start)


if __name__ == "__main__":
    sys.exit(main())
