"""A node of ROS 2 in a program that keeps its main thread."""

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import TypeVar

import rclpy
from rclpy.signals import SignalHandlerOptions

from ur_nodes.ports.node import Node
from ur_nodes.ros2.names import arguments_of
from ur_nodes.ros2.node import RosNode

Wired = TypeVar("Wired")


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
