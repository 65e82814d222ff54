"""The node keyboard_navigate: a map on a terminal, or commands from a pipe."""

import os
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass

from ur.source.ansi import is_plain
from ur_nodes.client.navigation import Names
from ur_nodes.client.navigator import RobotNavigator
from ur_nodes.client.saving import MapSaving, Saving, save_recordings
from ur_nodes.ports.node import Node
from ur_nodes.run import run_foreground
from ur_nodes.teleop.navigate.batch import BatchTimeouts
from ur_nodes.teleop.navigate.command_line import StoreChoice, name_growing_map
from ur_nodes.teleop.navigate.line_program import run_lines

_NAME = "keyboard_navigate"


@dataclass(frozen=True, slots=True)
class NavigateSession:
    """The robot, the waypoints of its map, and the saving of what has happened and of a map that is being made."""

    navigator: RobotNavigator
    stores: StoreChoice
    limits: BatchTimeouts
    recording: Saving
    saving: MapSaving | None
    clock: Callable[[], float]


def start(node: Node) -> NavigateSession:
    """Read the parameters, and wire up the robot."""
    own = node.parameters
    names = Names(
        map_frame=own.text("global_frame", "map"),
        base_frame=own.text("base_frame", "base_footprint"),
        plan_topic=own.text("plan_topic", "move_base/NavfnROS/plan"),
        mux=own.text("mux", "cmd_vel_mux"),
    )
    limits = BatchTimeouts(
        start=own.number("start_timeout", 60.0, minimum=0.0), goal=own.number("goal_timeout", 600.0, minimum=0.0)
    )
    map_name, file, service = own.text("map_name", ""), own.text("waypoints_file", ""), own.text("save_service", "")
    saving = MapSaving(node, service, hint="save: save the map") if service else None
    growing = name_growing_map(node, service) if service and not map_name and not file else None
    navigator, stores = RobotNavigator(node, names, _NAME), StoreChoice(file, map_name, growing)
    return NavigateSession(navigator, stores, limits, save_recordings(node), saving, node.steady)


def navigate(wired: NavigateSession, ended: threading.Event) -> int:
    """Run until `q`, Ctrl-C, the end of the pipe, or the end of the node. Returns the exit code."""
    on_terminal = sys.stdin.isatty() and sys.stdout.isatty()
    if not on_terminal or is_plain(os.environ):
        rest = wired.recording, wired.saving, ended, wired.clock
        return run_lines(_NAME, wired.navigator, wired.stores, wired.limits, *rest, attended=on_terminal)
    from ur_nodes.teleop.navigate.screen_program import run_screen  # a pipe needs no Textual

    return run_screen(_NAME, wired.navigator, wired.stores, wired.recording, wired.saving, ended)


def main() -> int:
    """Run the program. Returns the exit code."""
    return run_foreground(_NAME, start, navigate)


if __name__ == "__main__":
    sys.exit(main())
