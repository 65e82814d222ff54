"""Answers of a node to another thread."""

import threading
from collections.abc import Callable
from typing import TypeVar

from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node

Value = TypeVar("Value")


def await_answer(node: Node, ask: Callable[[Callable[[Value], None]], None], seconds: float) -> Value | None:
    """Call `ask` on the node's thread, and return what it passes to its argument; None: nothing within `seconds`."""
    found: list[Value] = []
    answered = threading.Event()

    def take(value: Value) -> None:
        found.append(value)
        answered.set()

    node.post(lambda: ask(take))
    answered.wait(seconds)
    return found[0] if found else None


def read_graph(node: Node, seconds: float) -> Graph:
    """Return the nodes and topics of now. Raises SystemExit: no answer within `seconds`."""
    graph: Graph | None = await_answer(node, node.read_graph, seconds)
    if graph is None:
        raise SystemExit(f"error: no list of topics within {seconds:g} s, expected one")
    return graph
