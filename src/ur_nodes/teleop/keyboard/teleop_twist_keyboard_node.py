"""Drive with the keys: the stand-in for teleop_twist_keyboard."""

from __future__ import annotations

import os
import sys
import threading

from ur.source.ansi import allows_colour, is_plain
from ur_nodes.client.mux import MuxLink
from ur_nodes.client.saving import MapSaving, save_recordings
from ur_nodes.ports.node import Node
from ur_nodes.run import run_foreground
from ur_nodes.teleop.keyboard.commander import make_commander
from ur_nodes.teleop.keyboard.drive import read_settings
from ur_nodes.teleop.keyboard.drive_terminal import drive_by_terminal
from ur_nodes.teleop.keyboard.key_driver import KeyDriver
from ur_nodes.teleop.keyboard.link_watch import make_watch
from ur_nodes.teleop.keyboard.pipe_driver import PipeDriver, drive_by_pipe
from ur_nodes.teleop.map_view.map_feed import MapFeed
from ur_nodes.teleop.terminal.raw import own_terminal

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
