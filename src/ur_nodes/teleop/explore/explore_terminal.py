"""An exploration on a terminal with its map, or as lines, until it ends."""

import shutil
import signal
import sys
import textwrap
import threading
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

from ur.source.ansi import BOLD, CYAN, DIM, GREEN, RED, RESET, REVERSE, YELLOW, cut_styled
from ur_nodes.client.exploration import ExplorationTopics
from ur_nodes.client.mux import EmergencyStop, MuxView, describe_emergency
from ur_nodes.client.saving import MapSaving, Saving, describe_stored
from ur_nodes.client.snapshot import RobotSnapshot
from ur_nodes.exploration.status import ExploreStatus, describe_blocked, describe_done, describe_left, describe_status
from ur_nodes.teleop.map_view.glyphs import Mark
from ur_nodes.teleop.map_view.map_feed import MapFeed
from ur_nodes.teleop.terminal.keys import Key
from ur_nodes.teleop.terminal.raw import RawTerminal, asks_to_save, asks_to_save_recording, mux_request_of

FRONTIER, GIVEN_UP = "?", "x"
"""The characters of frontiers on the map."""

_KEYS = "space: emergency stop  r: release  + - 0 f: map  Ctrl-C: end and save"
_SAVE_KEYS = "s: save the map  n: save what happened"
_EXPLORING = "▲ exploring"
_LEGEND = f"{FRONTIER} frontier  {GIVEN_UP} given up"
_BELOW_MAP = 5  # lines
_NARROWEST_MAP, _LOWEST_MAP = 30, 8


def room_for_map(columns: int, rows: int) -> tuple[int, int]:
    """Return columns and rows of the map above the lines about the exploration; 0, 0 if the screen is too small."""
    free = rows - _BELOW_MAP
    return (columns, free) if columns >= _NARROWEST_MAP and free >= _LOWEST_MAP else (0, 0)


def draw_explore_screen(
    status: ExploreStatus, mux: MuxView, note: str, columns: int, rows: int, map_lines: list[str]
) -> list[str]:
    """Return the lines of a map, as many as `room_for_map` has returned, and the exploration below: at most `rows`.

    `note` is the newest event, for example that the map was saved.
    """
    head, more = _state_lines(status, mux, columns)
    if not map_lines:  # a terminal too small for a map shows all that there is to say
        texts = [line for text in (more, note, f"{_KEYS}  {_SAVE_KEYS}") for line in textwrap.wrap(text, columns)]
        return [cut_styled(line, columns) for line in (head, *texts)][:rows]
    news = f"{YELLOW}{note}{RESET}" if note else f"{DIM}{_LEGEND}{RESET}"
    below = [head, f"{DIM}{_shorten(more, columns)}{RESET}", news, f"{DIM}{_KEYS}{RESET}", f"{DIM}{_SAVE_KEYS}{RESET}"]
    return [*map_lines, *(cut_styled(line, columns) for line in below)][:rows]


def _state_lines(status: ExploreStatus, mux: MuxView, columns: int) -> tuple[str, str]:
    """Return a coloured line with the state, and a plain line with details."""
    if alarm := describe_emergency(mux, "r lets the robot drive again"):
        return f"{RED}{REVERSE}{BOLD} {alarm} {RESET}", describe_done(status)
    if status.state == "starting":
        return f"{CYAN}{describe_status(status)}{RESET}", ""
    if status.state == "paused":
        return f"{YELLOW}{BOLD}■ paused: {status.reason}{RESET}", f"{describe_done(status)}; {describe_left(status)}"
    done, left, blocked = describe_done(status), describe_left(status), describe_blocked(status)
    if len(f"{_EXPLORING}  {done}; {left}") > columns:
        blocked = f"{left}; {blocked}" if blocked else left
    else:
        done = f"{done}; {left}"
    return f"{GREEN}{BOLD}{_EXPLORING}{RESET}  {done}", blocked


def _shorten(text: str, columns: int) -> str:
    return text if len(text) <= columns else text[: max(columns - 1, 0)] + "…"


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
