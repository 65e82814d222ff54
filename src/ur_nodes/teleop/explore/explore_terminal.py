"""An exploration on a terminal with its map, or as lines, until it ends."""

from __future__ import annotations

import shutil
import signal
import sys
import textwrap
import threading
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

from ur_nodes.client.exploration import ExplorationTopics
from ur_nodes.client.mux import EmergencyStop
from ur_nodes.client.saving import MapSaving, Saving, describe_stored
from ur_nodes.client.snapshot import RobotSnapshot
from ur_nodes.exploration.status import ExploreStatus, describe_left, describe_status
from ur_nodes.teleop.explore.explore_screen import FRONTIER, GIVEN_UP, draw_explore_screen, room_for_map
from ur_nodes.teleop.map_view.glyphs import Mark
from ur_nodes.teleop.map_view.map_feed import MapFeed
from ur_nodes.teleop.terminal.keys import Key
from ur_nodes.teleop.terminal.raw import RawTerminal
from ur_nodes.teleop.terminal.request_keys import asks_to_save, asks_to_save_recording, mux_request_of

_POLL = 0.1  # s
_REDRAW_ALL = 2.0  # s: other programs may have written on the screen


class Statuses(Protocol):
    """The newest status of an exploration."""

    newest: ExploreStatus


def add_exploration(topics: ExplorationTopics, snapshot: RobotSnapshot) -> tuple[RobotSnapshot, Sequence[Mark]]:
    """Return the snapshot with goal and path, and the frontiers as characters."""
    marks = [Mark(each.x, each.y, GIVEN_UP if each.blocked else FRONTIER, each.blocked) for each in topics.frontiers]
    return topics.add(snapshot), marks


def show_exploration(
    terminal: RawTerminal,
    statuses: Statuses,
    growing: MapFeed,
    mux: EmergencyStop,
    recording: Saving,
    saving: MapSaving | None,
    ended: threading.Event,
) -> None:
    """Show map and progress until the exploration ends, Ctrl-C is pressed, the terminal closes, or `ended` is set."""
    note, drawn_at = "", -_REDRAW_ALL
    while not ended.is_set() and not statuses.newest.ended:
        keys = terminal.read_keys(_POLL)
        if keys is None:
            return
        for key in keys:
            if isinstance(key, Key) and key.ctrl and key.name in ("c", "d"):
                return
            if (request := mux_request_of(key)) is not None:
                mux.ask(request)
            if saving and asks_to_save(key):
                saving.ask()
            if asks_to_save_recording(key):
                recording.ask()
            if isinstance(key, Key) and key.action == "press" and not key.ctrl:
                growing.press(key.name)
        note = (saving.pop_news() if saving else "") or recording.pop_news() or note
        now = time.monotonic()
        again = now - drawn_at >= _REDRAW_ALL
        drawn_at = now if again else drawn_at
        columns, rows = terminal.size()
        wide, high = room_for_map(columns, rows)
        picture = growing.lines(wide, high, now) if wide else []
        terminal.show(draw_explore_screen(statuses.newest, mux.view(), note, columns, rows, picture), again=again)


def print_exploration(statuses: Statuses, every: float, ended: threading.Event) -> None:
    """Print a line every `every` seconds and for each new state, until the exploration ends."""
    shown, shown_at = "", -every
    while not ended.wait(_POLL):
        status = statuses.newest
        if status.ended:
            return
        if status == ExploreStatus():
            continue
        if status.state != shown or time.monotonic() - shown_at >= every:
            shown, shown_at = status.state, time.monotonic()
            _print(describe_status(status))


def finish(program: str, status: ExploreStatus) -> int:
    """Print the result of the exploration and the place of its map; return the exit code."""
    if not status.ended:
        left = f"; {describe_left(replace(status, left=None))}" if status.known else ""
        _print(f"stopped before the map was complete{left}")
    else:
        _print(describe_status(status))
    if status.saved:
        _print(describe_stored(status.saved))
    else:
        sys.stderr.write(f"error: {program}: no map is stored, expected one of this exploration\n")
    return exit_code(status)


def exit_code(status: ExploreStatus) -> int:
    """0: complete, and saved. 1: it ended by itself before that. 130: the user ended it."""
    if not status.ended or status.state == "stopped":
        return 128 + signal.SIGINT
    return 0 if status.state == "complete" and status.saved else 1


def _print(line: str) -> None:
    if sys.stdout.isatty() and len(line) > (columns := shutil.get_terminal_size().columns):
        line = textwrap.fill(line, columns, break_long_words=False, break_on_hyphens=False)
    sys.stdout.write(line + "\n")
    sys.stdout.flush()
