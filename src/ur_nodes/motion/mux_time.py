"""The clock of a mux."""

from ur_nodes.ports.node import Node


def read_mux_time(node: Node) -> float:
    """Return the seconds of a steady clock, or of the simulator's clock if nodes use that."""
    return node.now() * 1e-9 if node.facts.simulated_time else node.steady()
