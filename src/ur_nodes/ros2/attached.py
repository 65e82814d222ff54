"""A node of ROS 2 in a program that keeps its main thread."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

import rclpy
from rclpy.signals import SignalHandlerOptions

from ur_nodes.ports.node import Node
from ur_nodes.ros2.names import arguments_of
from ur_nodes.ros2.node import RosNode

Wired = TypeVar("Wired")

PROFILE = Path(__file__).with_name("fast_dds.xml")
_VARIABLES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")
_OLD_RELEASE = "jazzy"  # reads the second, of which later ones warn


def choose_profile() -> None:
    """Have Fast DDS read the profile of this project's nodes, unless the user has chosen one. Before the first node."""
    if not any(os.environ.get(name) for name in _VARIABLES):
        os.environ[_VARIABLES[os.environ.get("ROS_DISTRO") == _OLD_RELEASE]] = str(PROFILE)


@contextlib.contextmanager
def attach(
    name: str, start: Callable[[Node], Wired], end: Callable[[], None], *, quiet: bool = True
) -> Iterator[tuple[Wired, RosNode]]:
    """Create the node `name` (remappable), call `start`, then run callbacks on a thread of the node.

    `end` is called on any thread when the node ends itself, and when a callback has failed. Signals stay the program's;
    with `quiet` nothing is written on the terminal. Leaving the context ends the node.
    """
    arguments = arguments_of(sys.argv[1:])
    if quiet:
        arguments += [*([] if "--ros-args" in arguments else ["--ros-args"]), "--disable-stdout-logs"]
    choose_profile()
    rclpy.init(args=[name, *arguments], signal_handler_options=SignalHandlerOptions.NO)
    node = RosNode(name)
    node.ended = lambda _reason: end()
    try:
        wired = start(node)
        node.begin(end)
        yield wired, node
    finally:
        node.close()
        rclpy.try_shutdown()
