"""The input line, which receives every key: history, and the map's keys."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from textual import events
from textual.widgets import Input

from ur.maps.names import waypoint_path
from ur_nodes.client.patrol_text import PatrolRoute, PatrolStop
from ur_nodes.client.saving import MapSaving
from ur_nodes.client.snapshot import RobotSnapshot, heading_there
from ur_nodes.client.waypoints import WaypointStore, name_of_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.teleop.navigate.commands import DrivePatrol, Go, GoToWaypoint

_SAVE_AGAIN = 2.0  # s until the name of a map that could not be saved is asked for again


@dataclass(frozen=True, slots=True)
class StoreChoice:
    """Chooses the file of waypoints: `file` if it is given, else that of the map, by its name or by its content.

    `growing` saves a map that is being made, whose content changes: its name is the one that it is saved under.
    """

    file: str = ""
    map_name: str = ""
    growing: MapSaving | None = None

    @property
    def title(self) -> str:
        """Return the name of the map for a screen."""
        return Path(self.map_name).stem

    def store_for(self, snapshot: RobotSnapshot) -> WaypointStore | None:
        """Return the waypoints once the map has arrived; None while it has no name."""
        if self.file:
            return WaypointStore(Path(self.file).expanduser())
        if self.map_name or self.growing:
            name = self.map_name or (self.growing.name if self.growing else "")
        else:
            assert snapshot.grid is not None, "asked for once the map has arrived"
            name = name_of_map(snapshot.grid)
        return WaypointStore(waypoint_path(name, os.environ)) if name else None


def name_growing_map(node: Node, service: str) -> MapSaving:
    """Save the map that is being made, again until it has a name."""
    saving = MapSaving(node, service, hint="")

    def ask() -> None:
        if saving.name:
            timer.cancel()
        else:
            saving.ask()

    timer = node.every(_SAVE_AGAIN, ask, steady=True)
    saving.ask()
    return saving


def target_of(command: Go | GoToWaypoint, snapshot: RobotSnapshot, store: WaypointStore) -> tuple[Pose2, bool]:
    """Return the goal of a command on the map, and whether any heading is accepted.

    Raises UserError: no such waypoint.
    """
    if isinstance(command, GoToWaypoint):
        return store.find(command.name), False
    yaw = heading_there(snapshot.pose, command.x, command.y) if command.yaw is None else command.yaw
    return Pose2(command.x, command.y, yaw), command.yaw is None


def route_of(command: DrivePatrol, store: WaypointStore) -> PatrolRoute:
    """Return the route of a patrol. Raises UserError for an unknown waypoint."""
    return PatrolRoute(tuple(PatrolStop(name, *store.find(name)) for name in command.names), command.loop, command.wait)


EMPTY_LINE_KEYS = frozenset({"plus", "minus", "equals_sign", "0", "left", "right", "pageup", "pagedown"})
"""Keys that no command begins with: they are the map's while nothing is typed."""

MAP_MODE_KEYS = EMPTY_LINE_KEYS | {"up", "down", "h", "j", "k", "l", "f", "t"}
"""Keys that are the map's after Tab, until another key begins a command."""

_HINTS = ("Space: emergency stop", "?: help", "q: quit", "g X Y", "m NAME", "n: save what happened")
_MAP_HINTS = ("map: h j k l + - 0 f t", "Tab: commands")


class KeyOwner(Protocol):
    """The program around the line, called while a key is handled, so that keys act in the order of typing."""

    def press_key(self, key: str) -> bool:
        """Offer a key to an open panel; return whether the panel took it."""

    def press_map_key(self, key: str) -> None:
        """Act on a key of the map."""

    def press_emergency_key(self) -> None:
        """Stop everything that drives."""

    def show_help(self) -> None:
        """Open the help."""

    def enter(self, line: str) -> None:
        """Act on a line, which may be empty."""


class CommandLine(Input):
    """Takes every key of the program, in order. Up and down move through earlier lines."""

    def __init__(self, owner: KeyOwner, *, id: str | None = None) -> None:
        super().__init__(id=id, compact=True, select_on_focus=False)
        self._owner = owner
        self._history: list[str] = []
        self._at = 0
        self._map_mode = False

    async def on_key(self, event: events.Key) -> None:
        """Take a key. Textual would handle Enter and similar keys only after later characters are in the line."""
        if self._take(event.key):
            event.stop()
            event.prevent_default()

    def _take(self, key: str) -> bool:
        if self._owner.press_key(key):
            return True
        if key == "space" and (not self.value or self.value[-1] == " "):
            self._owner.press_emergency_key()  # no command begins with a space or holds two in a row
        elif key == "question_mark" and not self.value:
            self._owner.show_help()
        elif key == "tab":
            self.set_map_mode(not self._map_mode)
        elif key in (MAP_MODE_KEYS if self._map_mode else () if self.value else EMPTY_LINE_KEYS):
            self._owner.press_map_key(key)
        else:
            self.set_map_mode(False)
            return self._edit(key)
        return True

    def insert_typed(self, text: str) -> None:
        """Take text that was typed before the screen opened: whole lines are entered, the rest stays in the line."""
        *lines, rest = text.replace("\r", "\n").split("\n")
        for line in lines:
            self.value = line
            self._submit()
        self.value = rest
        self.cursor_position = len(rest)

    def set_map_mode(self, on: bool) -> None:
        """Let letters be the map's keys, or begin commands."""
        self._map_mode = on
        self._show_hints()

    def on_resize(self) -> None:
        """Show the hints that have room."""
        self._show_hints()

    def _show_hints(self) -> None:
        shown = ""
        for each in _MAP_HINTS if self._map_mode else _HINTS:
            longer = f"{shown}   {each}" if shown else each
            if len(longer) >= self.size.width:  # the cursor needs a column
                break
            shown = longer
        self.placeholder = shown

    def _edit(self, key: str) -> bool:
        if key in ("enter", "ctrl+j"):  # what was typed before the screen opened ends with the other one
            self._submit()
        elif key in ("up", "down"):
            self._at = max(0, min((self._at + (1 if key == "down" else -1)), len(self._history)))
            self.value = self._history[self._at] if self._at < len(self._history) else ""
            self.cursor_position = len(self.value)
        elif key == "escape":
            self.value = ""
        elif key in ("backspace", "ctrl+h"):
            self.action_delete_left()
        elif key == "delete":
            self.action_delete_right()
        elif key in ("left", "right"):
            (self.action_cursor_left if key == "left" else self.action_cursor_right)()
        elif key in ("home", "ctrl+a"):
            self.action_home()
        elif key in ("end", "ctrl+e"):
            self.action_end()
        elif key == "ctrl+u":
            self.action_delete_left_all()
        elif key == "ctrl+w":
            self.action_delete_left_word()
        else:
            return False
        return True

    def _submit(self) -> None:
        line = self.value.strip()
        self.value = ""
        if line and (not self._history or self._history[-1] != line):
            self._history.append(line)
        self._at = len(self._history)
        self._owner.enter(line)
