"""The start of a node on the middleware of this computer."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ur_nodes.ports.node import Node


def run(name: str, start: Callable[[Node], object], *, own_terminal: bool = False) -> int:
    """Start a node under a name that can be remapped, and run it until it ends. Returns the exit code.

    `start` wires it up; what it returns lives as long as the node. A UserError from it ends the node with its
    diagnostics on standard error and exit code 2, an exception in a callback with exit code 1. With `own_terminal`
    nothing else writes to the terminal.
    """
    from ur_nodes.ros1 import run as backend  # the only one so far; ROS is loaded for nodes that run

    return backend.run(name, start, own_terminal=own_terminal)


def own_arguments(arguments: Sequence[str]) -> list[str]:
    """The arguments of a program that are its own, without those that remap names and set parameters."""
    return [each for each in arguments if ":=" not in each]
