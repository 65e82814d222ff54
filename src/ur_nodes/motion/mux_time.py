"""The time that a mux works by."""

from __future__ import annotations

from ur_nodes.ports.node import Node


def read_mux_time(node: Node) -> float:
    """Seconds of a steady clock, or of the simulator's where that is the clock of all nodes."""
    return node.now() * 1e-9 if node.facts.simulated_time else node.steady()
