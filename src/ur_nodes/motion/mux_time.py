"""The clock of a mux."""

from collections.abc import Callable

from ur_nodes.ports.node import Node


def mux_clock(node: Node) -> Callable[[], float]:
    """Return a function that reads the seconds of a steady clock, or of the simulator's clock if nodes use that."""
    return (lambda: node.now() * 1e-9) if node.facts.simulated_time else node.steady
