"""The persons at the commanders, inside a computer: each holds keys or a stick as a pattern says."""

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
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from bench.stop_network_parts.lane import GOALS, Lane, Pattern
from bench.stop_network_parts.screen import Screen
from bench.stop_parts.nursery import Child, Nursery
from bench.stop_parts.people import JOYSTICK, KEYBOARD, READER, JoystickPipe

PLAIN, PHONE, ROSTOPIC = "bench.stop_network_parts.plain_teleop", "bench.stop_network_parts.phone", "rostopic"
NAVIGATE = "ur_nodes.teleop.navigate.keyboard_navigate_node"
MODULES = (KEYBOARD, JOYSTICK, READER, PLAIN, PHONE, ROSTOPIC, NAVIGATE)
_ROUND = "g 7.23 10.63\ng 0 0\n" * 50  # through the whole maze and back
_LIBRARY = Path(__file__).resolve().parents[2] / "ubiquity_launches"
_KEYS = {("linear", 1): "i", ("linear", -1): ",", ("angular", 1): "j", ("angular", -1): "l"}
_TICK = 0.033  # s: how often a held key repeats


class Commander:
    """A commander of a lane with its person, who keeps to a pattern from `drive` on."""

    def __init__(self, nursery: Nursery, lane: Lane, folder: Path, more: Mapping[str, str]) -> None:
        """`more` are variables of its programs' environment; `folder` takes pipes."""
        self.lane = lane
        self._nursery = nursery
        self._folder = folder
        self._more = more
        self._pattern: Pattern | None = None
        self._since = 0.0
        self._sign = 0
        self._ended = threading.Event()
        self.children: list[Child] = []
        self._open()
        self._thread = threading.Thread(target=self._act, daemon=True)
        self._thread.start()

    def drive(self, pattern: Pattern | None) -> None:
        """Keep to a pattern from now on; None lets go."""
        self._since, self._pattern = time.monotonic(), pattern

    def signal(self, number: int) -> None:
        """Send a signal to its programs; the person goes on."""
        for child in self.children:
            child.signal(number)

    def press(self, key: str) -> None:
        """Press a key once."""
        raise NotImplementedError

    @property
    def screen(self) -> list[str]:
        """The lines that the person sees."""
        return []

    def close(self) -> None:
        """End it."""
        self._ended.set()
        self._thread.join()
        self.signal(signal.SIGKILL)
        self._close()

    def _start(self, module: str, *arguments: str, terminal: str = "", main: str = "main") -> None:
        self.children.append(
            self._nursery.bear(
                *(module, *arguments),
                namespace=self.lane.prefix,
                name=self.lane.name,
                terminal=terminal,
                more=self._more,
                main=main,
            )
        )

    def _act(self) -> None:
        while not self._ended.wait(_TICK):
            pattern = self._pattern
            with contextlib.suppress(OSError):
                self._hold(pattern.sign_at(time.monotonic() - self._since) if pattern else 0)

    def _open(self) -> None:
        raise NotImplementedError

    def _hold(self, sign: int) -> None:
        raise NotImplementedError

    def _close(self) -> None:
        """Close what `_open` opened."""


class KeyboardCommander(Commander):
    """Our keyboard program, or a plain one, on a terminal."""

    def _open(self) -> None:
        self._user, self._terminal = pty.openpty()
        fcntl.ioctl(self._terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        speed = self.lane.speed
        self._shown = Screen()
        name = f"__name:=teleop_{os.urandom(4).hex()}"
        arguments = [name, f"cmd_vel:={self.lane.topic}", f"_speed:={speed}", f"_turn:={speed}"]
        module = {"keyboard": KEYBOARD, "phone": PHONE}.get(self.lane.commander, PLAIN)
        self._start(module, *arguments, terminal=os.ttyname(self._terminal))

    def press(self, key: str) -> None:
        """Press a key once."""
        os.write(self._user, key.encode())

    @property
    def screen(self) -> list[str]:
        """The lines that the person sees."""
        return self._shown.lines()

    def _hold(self, sign: int) -> None:
        while select.select([self._user], [], [], 0.0)[0]:
            self._shown.feed(os.read(self._user, 65536))
        if sign:
            os.write(self._user, _KEYS[self.lane.axis, sign].encode())

    def _close(self) -> None:
        os.close(self._user)
        os.close(self._terminal)


class JoystickCommander(Commander):
    """Our joystick programs, and a pipe that speaks as a joystick does; the dead-man button is held while it drives."""

    def _open(self) -> None:
        device = self._folder / f"joystick-{self.lane.name}-{time.monotonic_ns()}"
        self._pipe = JoystickPipe(device)
        arguments = [f"__name:=teleop_{os.urandom(4).hex()}", f"cmd_vel:={self.lane.topic}"]
        arguments += [
            f"_{key}:={yaml.safe_dump(value, default_flow_style=True).split(chr(10))[0]}"
            for key, value in _joystick_parameters(self.lane.speed).items()
        ]
        self._start(JOYSTICK, *arguments)
        self._start(READER, "__name:=joy", f"_dev:={device}", "_autorepeat_rate:=30")

    def _hold(self, sign: int) -> None:
        if sign == self._sign:
            return
        self._sign = sign
        self._pipe.hold(*self.lane.pick(sign, 0), turbo=bool(sign))

    def _close(self) -> None:
        self._pipe.close()


class RostopicCommander(Commander):
    """`rostopic pub -r 20`, started for each direction and killed with Ctrl-C: it cannot do otherwise."""

    def _open(self) -> None:
        pass

    def _hold(self, sign: int) -> None:
        if sign == self._sign:
            return
        self._sign = sign
        for child in self.children:
            child.signal(signal.SIGINT)
        if sign:
            field = "linear: {x" if self.lane.axis == "linear" else "angular: {z"
            topic = f"/{self.lane.name}/{self.lane.topic}"
            message = f"{{{field}: {sign * self.lane.speed}}}}}"
            self._start(ROSTOPIC, "pub", "-r", "20", topic, "geometry_msgs/Twist", message, main="rostopicmain")


class GoalCommander(Commander):
    """`keyboard_navigate` with goals from a pipe, one after the other, from the first direction on."""

    def _open(self) -> None:
        path = self._folder / f"goals-{time.monotonic_ns()}"
        os.mkfifo(path)
        self._pipe = os.open(path, os.O_RDWR)
        self._start(NAVIGATE, "__name:=keyboard_navigate", terminal=str(path))

    def _hold(self, sign: int) -> None:
        if sign and not self._sign:
            self._sign = sign
            os.write(self._pipe, _ROUND.encode())

    def _close(self) -> None:
        os.close(self._pipe)


def make_commander(nursery: Nursery, lane: Lane, folder: Path, more: Mapping[str, str]) -> Commander:
    """Start the commander of a lane; `more` are variables of its environment."""
    kinds: dict[str, Any] = {"joystick": JoystickCommander, "rostopic": RostopicCommander, GOALS: GoalCommander}
    made: Commander = kinds.get(lane.commander, KeyboardCommander)(nursery, lane, folder, more)
    return made


def _joystick_parameters(speed: float) -> dict[str, Any]:
    path = _LIBRARY / "n_teleop_twist_joy" / "params" / "joysticks" / "xbox.yaml"
    values: dict[str, Any] = yaml.safe_load(path.read_text(encoding="utf-8"))
    return values | {"scale_linear_turbo": speed, "scale_angular_turbo": speed}
