"""Those who drive: real programs, each as a person or a goal would have them drive at full speed."""

from __future__ import annotations

import contextlib
import fcntl
import os
import pty
import select
import signal
import struct
import termios
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bench.stop_parts.nursery import Child, Nursery

KEYBOARD, JOYSTICK, NAVIGATION = (
    "ur_nodes.teleop.keyboard.teleop_twist_keyboard_node",
    "ur_nodes.motion.joystick.teleop_twist_joy_node",
    "ur_nodes.navigation.move_base_node",
)
READER = "ur_nodes.motion.joystick.joy_node"
_KEYS = {(1, 0): "i", (-1, 0): ",", (0, 1): "j", (1, 1): "u", (-1, 1): "."}
_REPEAT = 0.033  # s: how often a held key repeats
_RECORD = struct.Struct("=IhBB")  # of a joystick device: time, value, kind, number


class Keyboard:
    """The keyboard program on a terminal, and a finger that holds a key."""

    def __init__(self, nursery: Nursery, speed: float, turn: float) -> None:
        self._user, terminal = pty.openpty()
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        speeds = [f"_speed:={speed}", f"_turn:={turn}", f"_speed_limit:={speed}", f"_turn_limit:={turn}"]
        names = ["__name:=teleop_twist_keyboard", "cmd_vel:=key_vel"]
        self.teleop = nursery.bear(KEYBOARD, *names, *speeds, terminal=os.ttyname(terminal))
        self._terminal = terminal
        self._key = ""
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._type, daemon=True)
        self._thread.start()

    @property
    def viewer(self) -> Sequence[Child]:
        """All of it that is on the viewer."""
        return (self.teleop,)

    def drive(self, ahead: int, turn: int) -> None:
        """Hold the key for a direction."""
        self._key = _KEYS[ahead, turn]

    def _type(self) -> None:
        while not self._ended.wait(_REPEAT):
            with contextlib.suppress(OSError):
                if select.select([self._user], [], [], 0.0)[0]:
                    os.read(self._user, 65536)  # the screen
                os.write(self._user, self._key.encode())

    def close(self) -> None:
        """End it."""
        self.teleop.signal(signal.SIGKILL)
        self._ended.set()
        self._thread.join()
        os.close(self._user)
        os.close(self._terminal)


class JoystickPipe:
    """A pipe that speaks as a joystick does; `turbo` drives at full speed while it is held."""

    TURBO = 5  # the button

    def __init__(self, path: Path) -> None:
        os.mkfifo(path)
        self._pipe = os.open(path, os.O_RDWR)  # so that neither side waits for the other
        for kind, count in ((2, 2), (1, 8)):
            for number in range(count):
                self._write(kind | 0x80, number, 0)

    def hold(self, ahead: int, turn: int, *, turbo: bool) -> None:
        """Push the stick, each from -1 to 1, and press or release the button."""
        self._write(2, 1, -32767 * ahead)
        self._write(2, 0, -32767 * turn)
        self._write(1, self.TURBO, int(turbo))

    def close(self) -> None:
        """Close it."""
        os.close(self._pipe)

    def _write(self, kind: int, number: int, value: int) -> None:
        os.write(self._pipe, _RECORD.pack(0, value, kind, number))


class Joystick:
    """A joystick, what reads it, and the teleop that drives by it."""

    def __init__(self, nursery: Nursery, device: Path) -> None:
        """`device` is where the pipe is made."""
        self._pipe = JoystickPipe(device)
        self.teleop = nursery.bear(JOYSTICK, "__name:=teleop_twist_joy", "cmd_vel:=joy_vel")
        self._reader = nursery.bear(READER, "__name:=joy", f"_dev:={device}", "_autorepeat_rate:=30")

    @property
    def viewer(self) -> Sequence[Child]:
        """All of it that is on the viewer."""
        return (self.teleop, self._reader)

    def drive(self, ahead: int, turn: int) -> None:
        """Hold the button for full speed and push the stick."""
        self._pipe.hold(ahead, turn, turbo=True)

    def close(self) -> None:
        """End it."""
        for child in self.viewer:
            child.signal(signal.SIGKILL)
        self._pipe.close()


class Navigation:
    """move_base with the base's parameters, and a goal far ahead."""

    def __init__(self, nursery: Nursery) -> None:
        import rospy
        from geometry_msgs.msg import PoseStamped

        self.teleop = nursery.bear(NAVIGATION, "__name:=move_base", "cmd_vel:=nav_vel")
        self._goals: Any = rospy.Publisher("move_base_simple/goal", PoseStamped, queue_size=1)

    def drive(self, x: float, y: float) -> None:
        """Send it to a place of the map."""
        from geometry_msgs.msg import PoseStamped

        goal = PoseStamped()
        goal.header.frame_id = "map"
        goal.pose.position.x, goal.pose.position.y, goal.pose.orientation.w = x, y, 1.0
        self._goals.publish(goal)

    def close(self) -> None:
        """End it."""
        self.teleop.signal(signal.SIGKILL)


def wait_for(condition: Any, what: str, seconds: float = 60.0) -> None:
    """Wait until something is so; end the bench with a word if it does not come."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"bench/stop: waited {seconds:g} s for {what}")
        time.sleep(0.002)
