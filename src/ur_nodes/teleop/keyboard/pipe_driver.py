"""Driving with keys from a pipe, each for half a second, on the node's thread."""

import os
import select
import sys
import threading
from collections import deque
from collections.abc import Iterable
from dataclasses import replace

from ur_nodes.ports.node import Node
from ur_nodes.teleop.keyboard.commander import Commander, call_in_time, explain_refusal
from ur_nodes.teleop.keyboard.drive import STILL, DriveSettings, start_drive, step_drive, use_settings
from ur_nodes.teleop.terminal.keys import Key, KeyEvent, decode_keys

_HOLD = 0.5  # s: how long each key drives
_LISTENER_WAIT = 5.0  # s: the first key waits this long for a subscriber
_LEASE_WAIT = 10.0  # s: and at most this long to know who drives
_POLL = 0.05  # s


class PipeDriver:
    """Drives by one key after another. `press`, `close` and its properties may be used by any thread."""

    def __init__(self, node: Node, settings: DriveSettings, rate: float, commander: Commander) -> None:
        """`rate` is the least number of commands per second."""
        self._node, self._commander = node, commander
        self._state = start_drive(replace(settings, key_timeout=_HOLD))
        self._keys: deque[KeyEvent] = deque()
        self._began, self._linked_at = node.steady(), 0.0
        self._linked = self._ready = self._closed = False
        self.warning = ""
        """A line for the user, about a missing subscriber."""
        self.problem = ""
        """The reason why it does not drive."""
        self.ended = False
        """True when nothing more will be driven."""
        call_in_time(node, commander, rate, self._step, lambda: self._state.moving)
        node.on_end(self._end)

    def use(self, settings: DriveSettings) -> None:
        """Use changed settings from the next command on."""
        self._state = use_settings(self._state, replace(settings, key_timeout=_HOLD))

    @property
    def busy(self) -> bool:
        """True while keys wait for their turn."""
        return bool(self._keys)

    def press(self, events: Iterable[KeyEvent]) -> None:
        """Append keys; line ends are ignored."""
        keys = [event for event in events if isinstance(event, Key) and event.name != "enter"]
        self._node.post(lambda: self._keys.extend(keys))

    def close(self) -> None:
        """End once the waiting keys are driven."""
        self._node.post(self._close)

    def _close(self) -> None:
        self._closed = True

    def _step(self) -> None:
        self._ready = self._ready or self._may_drive()
        if self.ended or not self._ready:
            return
        now = self._node.steady()
        self._state, motion = step_drive(self._state, None, now)
        while self._keys and not self._state.moving and not self._state.quit:
            self._state, motion = step_drive(self._state, self._keys.popleft(), now)
        if motion is not None:
            self._commander.send(motion)
        else:
            self.ended = self._state.quit or (self._closed and not self._keys)

    def _may_drive(self) -> bool:
        """Wait for a subscriber, then for the lease; return whether the first key may drive."""
        now, link = self._node.steady(), self._commander.link()
        if not self._linked:
            if not link.subscribers and now - self._began < _LISTENER_WAIT:
                return False
            self._linked, self._linked_at = True, now
            if not link.subscribers:
                self.warning = (
                    f"no subscriber on {link.topic} after {_LISTENER_WAIT:g} s; is the robot running? Driving anyway"
                )
        if not self._commander.settled() and now - self._linked_at < _LEASE_WAIT:
            return False
        self.problem = explain_refusal(self._commander)
        self.ended = bool(self.problem)
        return not self.problem

    def _end(self) -> None:
        self._commander.send(STILL)
        self._commander.close()


def drive_by_pipe(name: str, source: int, driver: PipeDriver, ended: threading.Event) -> int:
    """Read keys from a file descriptor until its end, and wait until they are driven. Returns the exit code."""
    rest, is_open, warned = b"", True, ""
    while not ended.is_set() and not driver.ended:
        if driver.warning != warned:
            warned = driver.warning
            sys.stderr.write(f"warning: {name}: {warned}\n")
        if driver.busy or not is_open:
            ended.wait(_POLL)
        elif select.select([source], [], [], _POLL)[0]:  # a signal alone does not end a read
            data = os.read(source, 1024)
            events, rest = decode_keys(rest + data, final=not data)
            driver.press(events)
            if not data:
                driver.close()
                is_open = False
    if driver.problem:
        sys.stderr.write(f"error: {name}: {driver.problem}\n")
    return 1 if driver.problem else 0
