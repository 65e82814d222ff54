"""Requests of clients of slam_toolbox: to pause the mapping, and to save its map as a file."""

from __future__ import annotations

from ur_nodes.mapping.save_requests import SaveRequests
from ur_nodes.ports.node import Node
from ur_nodes.ports.services import Pause
from ur_nodes.ports.values import Result


class SlamRequests:
    """Serves the requests; `paused` while scans are ignored."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self.paused = False
        self._saves = SaveRequests(node, own="slam_toolbox/save_map")
        node.serve("slam_toolbox/pause_new_measurements", Pause, self._pause)

    def _pause(self, _request: Pause) -> Result:
        self.paused = not self.paused
        self._node.log.info("scans are not used any more" if self.paused else "scans are used again")
        return Result(success=True)
