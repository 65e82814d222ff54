"""The program `explore_progress`: shows an exploration with its map on a terminal, or as lines, until it ends."""

import os
import sys
import threading
from dataclasses import dataclass
from functools import partial

from ur.source.ansi import allows_colour, is_plain
from ur_nodes.client.exploration import ExplorationStatus, ExplorationTopics
from ur_nodes.client.mux import MuxLink
from ur_nodes.client.saving import MapSaving, Saving, save_recordings
from ur_nodes.ports.node import Node
from ur_nodes.run import run_foreground
from ur_nodes.teleop.explore.explore_terminal import add_exploration, finish, print_exploration, show_exploration
from ur_nodes.teleop.map_view.map_feed import MapFeed
from ur_nodes.teleop.terminal.raw import own_terminal

_NAME = "explore_progress"


@dataclass(frozen=True, slots=True)
class Screen:
    """The parts that only a terminal shows."""

    growing: MapFeed
    mux: MuxLink
    recording: Saving
    saving: MapSaving | None


@dataclass(frozen=True, slots=True)
class ExploreProgress:
    """The status of the exploration, the time between two lines (s), and a screen if the terminal can draw."""

    statuses: ExplorationStatus
    every: float
    screen: Screen | None


def start(node: Node) -> ExploreProgress:
    """Read the parameters and subscribe."""
    own = node.parameters
    every = own.number("print_every", 10.0, minimum=0.5, maximum=3600.0)
    drawn = own.boolean("show_map", True) and sys.stdin.isatty() and sys.stdout.isatty() and not is_plain(os.environ)
    return ExploreProgress(ExplorationStatus(node), every, _make_screen(node) if drawn else None)


def _make_screen(node: Node) -> Screen:
    own = node.parameters
    service = own.text("save_service", "")
    frames = own.text("map_frame", "map"), own.text("base_frame", "base_footprint")
    additions = partial(add_exploration, ExplorationTopics(node))
    growing = MapFeed(node, *frames, colour=allows_colour(os.environ), additions=additions)
    saving = MapSaving(node, service, hint="") if service else None
    return Screen(growing, MuxLink(node, own.text("mux", "cmd_vel_mux")), save_recordings(node), saving)


def follow(wired: ExploreProgress, ended: threading.Event) -> int:
    """Run until the exploration or the program ends; see `exit_code`."""
    if (screen := wired.screen) is not None:
        with own_terminal(0, 1, colours=allows_colour(os.environ)) as terminal:
            saves = screen.recording, screen.saving
            show_exploration(terminal, wired.statuses, screen.growing, screen.mux, *saves, ended)
    else:
        print_exploration(wired.statuses, wired.every, ended)
    return finish(_NAME, wired.statuses.newest)


def main() -> int:
    """Run the program. Returns the exit code."""
    return run_foreground(_NAME, start, follow)


if __name__ == "__main__":
    sys.exit(main())
