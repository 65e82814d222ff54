"""The start of a node in the process of all nodes."""

import sys
from collections.abc import Callable

from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.one_process.context import current_context
from ur_nodes.ports.node import Node


def run(name: str, start: Callable[[Node], object], *, own_terminal: bool = False) -> int:  # noqa: ARG001
    """Run a node until it ends; see `ur_nodes.run.run`. Nothing is written on the terminal."""
    try:
        _wired, node = current_context(name).wire(name, start)
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics))
        return 2
    node.over.wait()
    return int(node.failed)
