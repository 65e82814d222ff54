"""The bus of nodes."""

from typing import ClassVar

from ur_nodes.memory.carrier import Carrier
from ur_nodes.memory.node import MemoryNode

REPLACED = "another node took its name"


class Bus(Carrier):
    """See Carrier. `nodes` has them by their full names; they are of the class `node_class`."""

    node_class: ClassVar[type[MemoryNode]] = MemoryNode

    def node(self, name: str, remaps: dict[str, str] | None = None) -> MemoryNode:
        """Make a node; an existing one of the same name ends, as with a master."""
        node = self.node_class(self, name, remaps or {})
        if node.name in self.nodes:
            self.nodes[node.name].end(REPLACED)
        self.nodes[node.name] = node
        return node
