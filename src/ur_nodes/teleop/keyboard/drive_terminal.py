"""Driving with the keys of a terminal: reads keys, and shows the drive."""

from __future__ import annotations

import threading
import time

from ur_nodes.teleop.keyboard.drive_screen import describe_drive, draw_drive_screen, draw_map_screen, map_room
from ur_nodes.teleop.keyboard.key_driver import DriveView, KeyDriver
from ur_nodes.teleop.map_view.map_feed import MapFeed
from ur_nodes.teleop.terminal.raw import RawTerminal

_AT_REST, _MOVING, _AFTER_A_KEY = 0.2, 0.03, 0.01  # s until the screen is drawn again
_REDRAW_ALL = 2.0  # s: other programs may have written on the screen
_ALIVE_EVERY = 0.25  # s


def drive_by_terminal(
    terminal: RawTerminal, driver: KeyDriver, ended: threading.Event, growing: MapFeed | None = None
) -> None:
    """Pass keys to the driver and show the drive until Ctrl-C, the terminal is closed, or `ended` is set.

    `growing` is a map that is shown above the rest.
    """
    asked_at, drawn_at = 0.0, -_REDRAW_ALL
    wait = 0.0
    while not ended.is_set():
        keys = terminal.read_keys(wait)
        if keys is None:
            return
        driver.press(keys)
        view, now = driver.view(), time.monotonic()
        if view.state.quit:
            return
        if view.state.moving and view.state.reports_release and now - asked_at > _ALIVE_EVERY:
            asked_at = now
            terminal.request_answer()
        again = now - drawn_at > _REDRAW_ALL
        drawn_at = now if again else drawn_at
        _show(terminal, view, growing, now, again=again)
        wait = _AFTER_A_KEY if keys else _MOVING if view.state.moving else _AT_REST


def _show(terminal: RawTerminal, view: DriveView, growing: MapFeed | None, now: float, *, again: bool) -> None:
    state, link, mux, driver = view.state, view.link, view.mux, view.driver
    if terminal.plain:
        terminal.show(describe_drive(state, link, mux, driver))
        return
    columns, rows = terminal.size()
    wide, high = map_room(columns, rows) if growing else (0, 0)
    if growing and wide:
        picture = growing.lines(wide, high, now)
        terminal.show(draw_map_screen(state, link, mux, columns, picture, driver), again=again)
    else:
        terminal.show(draw_drive_screen(state, link, mux, columns, rows, driver), again=again)
