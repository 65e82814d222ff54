"""The context of a node's module in the process of all nodes: the name under which it starts, and its bus."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TypeVar

from ur.source.diagnostic import user_error
from ur_nodes.one_process.bus import LiveBus, LiveNode
from ur_nodes.ports.node import Node

Wired = TypeVar("Wired")

_CONTEXT: ContextVar[NodeContext] = ContextVar("context")


@dataclass(frozen=True, slots=True)
class NodeContext:
    """`name` is the full name of the node, '' for the one that its module chooses; `remaps` has full names.

    `wired` gets the node, and then `started` is called.
    """

    bus: LiveBus
    name: str = ""
    remaps: dict[str, str] = field(default_factory=dict)
    started: Callable[[], None] = lambda: None
    wired: Callable[[LiveNode], None] = lambda _node: None

    def enter(self) -> None:
        """Make this the context of this thread."""
        _CONTEXT.set(self)

    def wire(self, name: str, start: Callable[[Node], Wired]) -> tuple[Wired, LiveNode]:
        """Make a node, and call `start` with it on the thread of the bus. Raises the exceptions of `start`."""

        def make() -> tuple[Wired, LiveNode]:
            names = itertools.chain([f"/{name}"], (f"/{name}_{number}" for number in itertools.count(2)))
            free = next(each for each in names if each not in self.bus.nodes)
            node = self.bus.node(self.name or free, self.remaps)
            assert isinstance(node, LiveNode)
            try:
                return start(node), node
            except BaseException:
                node.end("it cannot start", failed=True)
                raise

        wired, node = self.bus.do(make)
        self.wired(node)
        self.started()
        return wired, node


def current_context(name: str) -> NodeContext:
    """Return the context of this thread. Raises UserError in a process of its own."""
    try:
        return _CONTEXT.get()
    except LookupError:
        raise user_error(
            f"{name}: without ROS, all nodes run in the process of 'ur run', and other programs cannot reach them",
            rule="no-ros",
            help="ur use sim --ros 2",
        ) from None
