"""Driving with keys that a user presses, on the node's thread."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from ur_nodes.client.driver_text import DriverLine, line_of
from ur_nodes.client.mux import EmergencyStop, MuxView
from ur_nodes.client.saving import MapSaving, Saving
from ur_nodes.ports.node import Node
from ur_nodes.teleop.keyboard.commander import Commander, call_in_time
from ur_nodes.teleop.keyboard.drive import STILL, DriveSettings, DriveState, start_drive, step_drive, use_settings
from ur_nodes.teleop.keyboard.drive_screen import CommandTopic
from ur_nodes.teleop.terminal.keys import FocusLost, KeyEvent
from ur_nodes.teleop.terminal.raw import (
    asks_to_save,
    asks_to_save_recording,
    driver_request_of,
    mux_request_of,
    obstacle_request_of,
)

SETTLE = 1.0
"""Seconds for which the connection has to be there before keys drive: those that a cut has held back come first."""

HUNG_AFTER = 0.3
"""Seconds without a call of `press` after which the user interface hangs, and keys drive no more."""


@dataclass(frozen=True, slots=True)
class DriveView:
    """The drive at one moment, for a screen."""

    state: DriveState
    link: CommandTopic
    mux: MuxView
    driver: DriverLine


class KeyDriver:
    """Sends velocities while keys are held. `press` and `view` may be used by any thread.

    A key counts from the time when it was pressed, however late the node handles it, and only while `press` is called
    repeatedly: a call without keys is the sign of life of a user interface that waits for keys.

    While a key drives, a command is also sent whenever a challenge has arrived, so that it is as young as can be. With
    `saving`, one key saves the map, and another what has happened by `recording`; they stop the robot as every other
    key does. At the end of the node the robot is stopped and the lease released.
    """

    def __init__(
        self,
        node: Node,
        settings: DriveSettings,
        rate: float,
        commander: Commander,
        mux: EmergencyStop,
        recording: Saving,
        saving: MapSaving | None = None,
        linked: Callable[[], bool] = lambda: True,
    ) -> None:
        """`rate` is the least number of commands per second.

        `linked` is whether the terminal is connected: keys drive only while it is.
        """
        self._node, self._commander, self._mux, self._saving = node, commander, mux, saving
        self._recording = recording
        self._state, self._linked = start_drive(settings), linked
        self._alive_at = node.steady()
        self._cut_at = float("-inf")  # the latest time without a connection
        call_in_time(node, commander, rate, self._step, lambda: self._state.moving)
        node.on_end(self._end)

    def use(self, settings: DriveSettings) -> None:
        """Use changed settings from the next command on."""
        self._state = use_settings(self._state, settings)

    def press(self, events: Iterable[KeyEvent]) -> None:
        """Apply keys in their order."""
        self._alive_at = now = self._node.steady()
        for event in events:
            self._node.post(lambda event=event: self._on_event(event, now))  # type: ignore[misc]  # mypy infers no default

    def view(self) -> DriveView:
        """Return the newest state."""
        commander = self._commander
        driver = line_of(commander.view(), commander.conduct)
        return DriveView(self._state, commander.link(), self._mux.view(), driver)

    def _on_event(self, event: KeyEvent, pressed_at: float) -> None:
        """Apply a key that was pressed at a time (s)."""
        # Send the request to mux, lease, map or black box that a key stands for, if any
        for mux_request in (mux_request_of(event), obstacle_request_of(event, self._mux.view())):
            if mux_request is not None:
                self._mux.ask(mux_request)
        if (request := driver_request_of(event)) is not None:
            self._commander.request(request)
        if self._saving and asks_to_save(event):
            self._saving.ask()
        if asks_to_save_recording(event):
            self._recording.ask()
        was_moving = self._state.moving
        self._state, motion = step_drive(self._state, event, pressed_at)
        if self._state.moving:  # it may have driven for long enough by now, or have waited for the connection
            now = self._node.steady()
            self._state, motion = step_drive(self._state, FocusLost() if self._is_cut(now) else None, now)
        if motion is not None and self._state.moving != was_moving:
            self._commander.send(motion)  # starts and stops are not kept waiting

    def _is_cut(self, now: float) -> bool:
        """Check the connection; return whether it is cut, or was cut less than `SETTLE` s ago."""
        if not self._linked():
            self._cut_at = now
        return now - self._cut_at < SETTLE

    def _step(self) -> None:
        for saving in (self._saving, self._recording):
            if saving and (news := saving.pop_news()):
                self._state = replace(self._state, note=news)
        now = self._node.steady()
        hangs = self._state.moving and now - self._alive_at > HUNG_AFTER
        cut = self._is_cut(now) and self._state.moving
        self._state, motion = step_drive(self._state, FocusLost() if hangs or cut else None, now)
        if hangs or cut:
            reason = (
                "the connection to this terminal is slow or cut" if cut else "the terminal does not take the screen"
            )
            self._state = replace(self._state, note=f"stopped: {reason}")
        if motion is not None:
            self._commander.send(motion)

    def _end(self) -> None:
        self._commander.send(STILL)
        self._commander.close()
