"""The keys that programs on a terminal share: emergency stop, obstacle stop, who drives, to save, and to quit."""

import os
import select
import threading

from ur_nodes.client.driver_text import DriverRequest
from ur_nodes.client.mux import MuxRequest, MuxView
from ur_nodes.teleop.terminal.keys import Key, KeyEvent


class QuitKey:
    """Reads a file descriptor for a `q`. Its end, as that of an empty pipe, does not end the program."""

    def __init__(self, source: int) -> None:
        self._source: int | None = source

    def wait(self, seconds: float, ended: threading.Event) -> bool:
        """Wait for `q` or for `ended`, at most `seconds`; return whether `q` was read."""
        if self._source is None:
            ended.wait(seconds)
        elif select.select([self._source], [], [], seconds)[0]:
            data = os.read(self._source, 1024)
            if b"q" in data:
                return True
            if not data:
                self._source = None
        return False


EMERGENCY_KEYS: dict[str, MuxRequest] = {"space": "stop", "r": "release"}
OBSTACLE_KEY = "g"
DRIVER_KEYS: dict[str, DriverRequest] = {"d": "take", "a": "ask", "y": "grant"}
SAVE_KEY = "s"
RECORDING_KEY = "n"


def mux_request_of(event: KeyEvent) -> MuxRequest | None:
    """Return the request to the mux that a key makes; None for any other key."""
    return EMERGENCY_KEYS.get(_pressed(event))


def obstacle_request_of(event: KeyEvent, view: MuxView) -> MuxRequest | None:
    """Return the request that turns the obstacle stop on or off; None for other keys, or without an obstacle stop."""
    if _pressed(event) != OBSTACLE_KEY or view.obstacles.state == "none":
        return None
    return "obstacles on" if view.obstacles.state == "off" else "obstacles off"


def driver_request_of(event: KeyEvent) -> DriverRequest | None:
    """Return the lease request of a key; None for any other key."""
    return DRIVER_KEYS.get(_pressed(event))


def asks_to_save(event: KeyEvent) -> bool:
    """Return whether a key asks to save the map."""
    return _pressed(event) == SAVE_KEY


def asks_to_save_recording(event: KeyEvent) -> bool:
    """Return whether a key asks to save what has happened."""
    return _pressed(event) == RECORDING_KEY


def _pressed(event: KeyEvent) -> str:
    """Return the name of a key that is pressed without Ctrl; '' for any other event."""
    return event.name if isinstance(event, Key) and event.action == "press" and not event.ctrl else ""
