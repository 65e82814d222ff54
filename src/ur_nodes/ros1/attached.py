"""A node of ROS 1 in a program whose main thread is its own."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from typing import TypeVar

import rosgraph
import rospy

from ur.source.diagnostic import user_error
from ur_nodes.ports.node import Node
from ur_nodes.ros1.node import RosNode
from ur_nodes.ros1.repairs.connections import bound_connections
from ur_nodes.ros1.repairs.logs import discard_line, report_log_errors
from ur_nodes.ros1.repairs.sending import send_at_once
from ur_nodes.ros1.run import silence_terminal

Wired = TypeVar("Wired")


@contextlib.contextmanager
def attach(name: str, start: Callable[[Node], Wired], end: Callable[[], None]) -> Iterator[tuple[Wired, AttachedNode]]:
    """Register as `name` (remappable), call `start`, then run callbacks on a thread of the node's own.

    `end` is called on any thread when the master or another node ends this one, and when a callback has failed. Signals
    stay the program's, and nothing is written on the terminal. Leaving the context ends the node. Raises UserError: no
    master.
    """
    if rospy.core.is_initialized():
        raise user_error(f"{name}: a program is one node, expected no other in it", rule="second-node")
    bound_connections()
    send_at_once()
    if not rosgraph.is_master_online():
        uri = os.environ.get("ROS_MASTER_URI", "(ROS_MASTER_URI is not set)")
        raise user_error(
            f"{name}: no ROS master at {uri}, expected a running one",
            rule="no-master",
            help="'ur run' and 'roslaunch' start one, 'roscore' does too",
        )
    try:
        rospy.init_node(name, disable_signals=True)
        report_log_errors(discard_line)
        silence_terminal()
        node = AttachedNode()

        def on_reason(reason: str) -> None:  # not by on_shutdown, whose callbacks run before the reason is known
            node.replaced = node.replaced or "new node registered" in reason
            end()

        rospy.core.add_preshutdown_hook(on_reason)
        wired = start(node)
        node.begin(end)
        yield wired, node
    finally:
        rospy.signal_shutdown("the program ended")


class AttachedNode(RosNode):
    """`replaced`: another node has registered under its name."""

    replaced = False
