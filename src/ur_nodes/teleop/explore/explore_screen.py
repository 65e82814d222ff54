"""The lines below the map while a robot explores: progress, frontiers that cannot be reached, notes and keys."""

from __future__ import annotations

import textwrap

from ur.source.ansi import BOLD, CYAN, DIM, GREEN, RED, RESET, REVERSE, YELLOW, cut_styled
from ur_nodes.client.mux import MuxView, describe_emergency
from ur_nodes.exploration.status import ExploreStatus, describe_blocked, describe_done, describe_left, describe_status

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
