"""The bus that nodes are made on."""

from __future__ import annotations

from ur_nodes.memory.carrier import Carrier
from ur_nodes.memory.node import MemoryNode


class Bus(Carrier):
    """See Carrier. `nodes` has them by their full names."""

    def node(self, name: str, remaps: dict[str, str] | None = None) -> MemoryNode:
        """A new node; one of the same name ends, as with a master."""
        node = MemoryNode(self, name, remaps or {})
        if node.name in self.nodes:
            self.nodes[node.name].end("another node took its name")
        self.nodes[node.name] = node
        return node
