"""Drive with the keys: the stand-in for teleop_twist_keyboard."""

import os
import struct
import sys
import threading
import time
from collections.abc import Callable, Mapping

from ur.source.ansi import allows_colour, is_plain
from ur_nodes.client.mux import MuxLink
from ur_nodes.client.saving import MapSaving, save_recordings
from ur_nodes.ports.node import Node
from ur_nodes.run import run_foreground
from ur_nodes.teleop.keyboard.commander import make_commander
from ur_nodes.teleop.keyboard.drive import read_settings
from ur_nodes.teleop.keyboard.drive_screen import describe_drive, draw_drive_screen, draw_map_screen, map_room
from ur_nodes.teleop.keyboard.key_driver import DriveView, KeyDriver
from ur_nodes.teleop.keyboard.pipe_driver import PipeDriver, drive_by_pipe
from ur_nodes.teleop.map_view.map_feed import MapFeed
from ur_nodes.teleop.terminal.raw import RawTerminal, own_terminal

# Monitor of the connection by which the keys of this terminal arrive, from a file that `link_guard` writes.
# A terminal over ssh does not notice a cut connection. So a guard beside this program sends numbers to the user's
# computer and gets them back; each that returns proves that the connection was there when it was sent.


VARIABLE = "UR_LINK"
"""The file; not set where the terminal is of this computer."""

LINK_LIMIT = 0.15
"""Seconds after which a proof is too old to drive by."""

_PROOF = struct.Struct("d")  # s, of the steady clock of this computer


def make_watch(environment: Mapping[str, str], now: Callable[[], float] = time.monotonic) -> Callable[[], bool]:
    """Return a function that returns whether the newest proof is fresh, which is always true without a guard."""
    path = environment.get(VARIABLE, "")
    if not path:
        return lambda: True

    def is_fresh() -> bool:
        try:
            descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
        except OSError:
            return False
        try:
            data = os.read(descriptor, _PROOF.size)
        finally:
            os.close(descriptor)
        return len(data) == _PROOF.size and now() - float(_PROOF.unpack(data)[0]) <= LINK_LIMIT

    return is_fresh


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


_NAME = "teleop_twist_keyboard"
_PROGRAM = "keyboard_drive"

Wired = PipeDriver | tuple[KeyDriver, MapFeed | None, MapSaving | None]


def start(node: Node) -> Wired:
    """Read the parameters, and wire up what drives."""
    own = node.parameters
    driver: PipeDriver | KeyDriver
    settings, rate = own.follow(read_settings, lambda changed: driver.use(changed[0]))
    mux, service = own.text("mux", "cmd_vel_mux"), own.text("save_service", "")
    commander = make_commander(node, mux, _PROGRAM)
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        driver = piped = PipeDriver(node, settings, rate, commander)
        return piped
    saving = MapSaving(node, service) if service else None
    driver = keys = KeyDriver(
        node, settings, rate, commander, MuxLink(node, mux), save_recordings(node), saving, make_watch(os.environ)
    )
    if is_plain(os.environ) or not own.boolean("show_map", False):
        return keys, None, saving
    frames = own.text("map_frame", "map"), own.text("base_frame", "base_footprint")
    return keys, MapFeed(node, *frames, colour=allows_colour(os.environ)), saving


def drive(wired: Wired, ended: threading.Event) -> int:
    """Run until Ctrl-C, the end of the pipe, or the end of the node. Returns the exit code."""
    if isinstance(wired, PipeDriver):
        return drive_by_pipe(_NAME, sys.stdin.fileno(), wired, ended)
    driver, growing, saving = wired
    plain, colours = is_plain(os.environ), allows_colour(os.environ)
    with own_terminal(sys.stdin.fileno(), sys.stdout.fileno(), plain=plain, colours=colours) as terminal:
        drive_by_terminal(terminal, driver, ended, growing)
    if saving and not ended.is_set():
        sys.stdout.write(f"{saving.save_last(ended)}\n")
    return 0


def main() -> int:
    """Run the program. Returns the exit code."""
    return run_foreground(_NAME, start, drive)


if __name__ == "__main__":
    sys.exit(main())
