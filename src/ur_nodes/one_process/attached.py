"""A node in the process of all nodes, for a user interface that has the main thread."""

import contextlib
from collections.abc import Callable, Iterator
from typing import TypeVar

from ur_nodes.one_process.bus import LiveNode
from ur_nodes.one_process.context import current_context
from ur_nodes.ports.node import Node

Wired = TypeVar("Wired")


@contextlib.contextmanager
def attach(name: str, start: Callable[[Node], Wired], end: Callable[[], None]) -> Iterator[tuple[Wired, LiveNode]]:
    """See `ur_nodes.run.attach`. Raises UserError: this program is not part of the process of all nodes."""
    context = current_context(name)
    wired, node = context.wire(name, start)
    node.at_over = end
    if node.over.is_set():
        end()
    try:
        yield wired, node
    finally:
        with contextlib.suppress(RuntimeError):  # the bus has ended before
            context.bus.do(lambda: node.end("the program ended"))
