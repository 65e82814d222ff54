"""The start of a node on ROS 1."""

from __future__ import annotations

from collections.abc import Callable

from ur_nodes.ports.node import Node
from ur_nodes.ros1.node import RosNode
from ur_nodes.ros1.shell import run_node


def run(name: str, start: Callable[[Node], object], *, own_terminal: bool = False) -> int:
    """Run a node until it ends; see `ur_nodes.run.run`."""
    nodes: list[RosNode] = []
    wired: list[object] = []

    def begin() -> None:
        node = RosNode()
        nodes.append(node)
        wired.append(start(node))
        node.begin()

    code = run_node(name, begin, own_terminal=own_terminal)
    return code or int(any(node.failed for node in nodes))
