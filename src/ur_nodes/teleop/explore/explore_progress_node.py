"""The program `explore_progress`: an exploration on a terminal with its map, or as lines, until it ends."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from dataclasses import replace
from typing import Protocol

from ur.source.ansi import allows_colour, is_plain
from ur_nodes.client.mux import Emergency
from ur_nodes.exploration.status import Status, describe_left, describe_status
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.teleop.explore.exploration_topics_node import ExplorationTopics, StatusTopic
from ur_nodes.teleop.explore.explore_screen import draw_explore_screen, room_for_map
from ur_nodes.teleop.map_view.map_feed_node import MapFeed
from ur_nodes.teleop.navigator.map_saving_node import MapSaving, call_save
from ur_nodes.teleop.navigator.mux_link_node import MuxLink
from ur_nodes.teleop.terminal.foreground_node import run_in_foreground
from ur_nodes.teleop.terminal.keys import Key, decode_keys
from ur_nodes.teleop.terminal.raw import Terminal, own_terminal
from ur_nodes.teleop.terminal.request_keys import asks_to_save, mux_request_of

_NAME = "explore_progress"
_POLL = 0.1  # s
_REDRAW_ALL = 2.0  # s: other programs may have written on the screen
_ESCAPE_WAIT = 0.05  # s: a sequence's bytes come together; ESC that stays alone is the key


class Statuses(Protocol):
    """The newest status of an exploration."""

    newest: Status


class MapLines(Protocol):
    """Draws the map that grows."""

    def lines(self, columns: int, rows: int, now: float) -> list[str]:
        """The map now (s) on so many characters."""

    def press(self, key: str) -> None:
        """Zoom by a key."""


def main() -> int:
    """Run until the exploration or the program ends; see `exit_code`."""
    return run_in_foreground(_NAME, _run)


def _run(ended: threading.Event) -> int:
    parameters = Parameters()
    every = parameters.number("print_every", 10.0, minimum=0.5, maximum=3600.0)
    show_map = parameters.boolean("show_map", True)
    statuses = StatusTopic()
    if show_map and sys.stdin.isatty() and sys.stdout.isatty() and not is_plain(os.environ):
        colours, service = allows_colour(os.environ), parameters.text("save_service", "")
        saving = MapSaving(lambda: call_save(service), hint="") if service else None
        mux = MuxLink(parameters.text("mux", "cmd_vel_mux"))
        frames = parameters.text("map_frame", "map"), parameters.text("base_frame", "base_footprint")
        growing = MapFeed(*frames, colour=colours, additions=ExplorationTopics())
        with own_terminal(sys.stdin.fileno(), sys.stdout.fileno(), colours=colours) as terminal:
            show_exploration(terminal, statuses, growing, mux, saving, ended)
    else:
        _print_lines(statuses, every, ended)
    return _finish(statuses.newest)


def show_exploration(
    terminal: Terminal,
    statuses: Statuses,
    growing: MapLines,
    mux: Emergency,
    saving: MapSaving | None,
    ended: threading.Event,
) -> None:
    """Show map and progress until the exploration ends, Ctrl-C is pressed, the terminal is gone, or `ended` is set."""
    rest, note, drawn_at = b"", "", -_REDRAW_ALL
    while not ended.is_set() and not statuses.newest.ended:
        data = terminal.read(_ESCAPE_WAIT if rest else _POLL)
        if data is None:
            return
        events, rest = decode_keys(rest + data, final=not data)
        for event in events:
            if isinstance(event, Key) and event.ctrl and event.name in ("c", "d"):
                return
            if (request := mux_request_of(event)) is not None:
                mux.ask(request)
            if saving and asks_to_save(event):
                saving.ask()
            if isinstance(event, Key) and event.action == "press" and not event.ctrl:
                growing.press(event.name)
        note = (saving.take_news() if saving else "") or note
        now = time.monotonic()
        again = now - drawn_at >= _REDRAW_ALL
        drawn_at = now if again else drawn_at
        columns, rows = terminal.size()
        wide, high = room_for_map(columns, rows)
        picture = growing.lines(wide, high, now) if wide else []
        terminal.show(draw_explore_screen(statuses.newest, mux.view(), note, columns, rows, picture), again=again)


def _print_lines(statuses: Statuses, every: float, ended: threading.Event) -> None:
    """Print a line every so many seconds, and one for each new state, until the exploration ends."""
    shown, shown_at = "", -every
    while not ended.wait(_POLL):
        status = statuses.newest
        if status.ended:
            return
        if status == Status():
            continue
        if status.state != shown or time.monotonic() - shown_at >= every:
            shown, shown_at = status.state, time.monotonic()
            _write(describe_status(status))


def _finish(status: Status) -> int:
    """Print how the exploration has ended and where its map is; return the exit code."""
    if not status.ended:
        left = f"; {describe_left(replace(status, left=None))}" if status.known else ""
        _write(f"stopped before the map was complete{left}")
    else:
        _write(describe_status(status))
    if status.saved:
        _write(f"the map is stored as '{status.saved}'; navigate on it with")
        _write(f"    ur run keyboard_navigate map:={status.saved}")
    else:
        sys.stderr.write(f"error: {_NAME}: no map is stored, expected one of this exploration\n")
    return exit_code(status)


def exit_code(status: Status) -> int:
    """0: complete, and saved. 1: it ended by itself before that. 130: somebody ended it."""
    if not status.ended or status.state == "stopped":
        return 128 + signal.SIGINT
    return 0 if status.state == "complete" and status.saved else 1


def _write(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
