"""The keyboard program's node on a bus, with a mux that only its user asks for something, or a whole one."""

import itertools
from typing import Any

from ur_nodes.client.mux import MuxLink
from ur_nodes.client.saving import save_recordings
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Twist
from ur_nodes.teleop.keyboard.commander import Commander, make_commander
from ur_nodes.teleop.keyboard.drive import DriveSettings
from ur_nodes.teleop.keyboard.key_driver import KeyDriver
from ur_nodes.teleop.terminal.keys import decode_keys

SETTINGS = DriveSettings(speed=0.4, turn=0.8, speed_limit=0.5, turn_limit=1.0)
RATE = 20.0
_WAIT = 0.05  # s
AHEAD, LEFT, STILL = Twist(0.4, 0.0), Twist(0.0, 0.8), Twist(0.0, 0.0)


class Rig:
    """A base that takes plain commands, and a user's keys."""

    def __init__(self, bus: Bus | None = None, *, topic: str = "cmd_vel", **parameters: Any) -> None:
        self.bus = bus or Bus()
        self.node = self.bus.node("keys", {"cmd_vel": f"/{topic}"})
        for name, value in parameters.items():
            self.bus.parameters[f"/keys/{name}"] = value
        self.commander: Commander = make_commander(self.node, "cmd_vel_mux", "keyboard_drive")
        self.sent: list[Twist] = []
        listener = self.bus.node("listener")
        listener.subscribe(topic, Twist, self.sent.append, Quality.EVERY)

    @property
    def changes(self) -> list[Twist]:
        """The commands without those that repeat the one before."""
        return [twist for twist, _ in itertools.groupby(self.sent)]


class Driving(Rig):
    """The driver of a terminal."""

    def __init__(self, bus: Bus | None = None, *, topic: str = "cmd_vel", **parameters: Any) -> None:
        super().__init__(bus, topic=topic, **parameters)
        self.driver = KeyDriver(
            self.node, SETTINGS, RATE, self.commander, MuxLink(self.node, "cmd_vel_mux"), save_recordings(self.node)
        )
        self._rest = b""

    def press(self, data: bytes, seconds: float = 0.0) -> None:
        """Let a terminal send bytes, and time pass, in which the user interface waits for more."""
        events, self._rest = decode_keys(self._rest + data, final=True)
        self.driver.press(events)
        while seconds > 0.0:
            self.bus.run(min(seconds, _WAIT))
            self.driver.press(())
            seconds -= _WAIT
