"""The outputs of an exploration: its status, log lines and frontiers."""

from __future__ import annotations

from ur_nodes.exploration.explorer import Explorer
from ur_nodes.exploration.explorer_step import ExplorerOutputs
from ur_nodes.exploration.markers import mark_frontiers
from ur_nodes.exploration.status import ExploreStatus, describe_status, write_status
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Markers

_SHOWN_EVERY = 10.0  # s between two lines in the log


class StatusOutput:
    """Publishes each status, logs its changes, and publishes the frontiers while they have subscribers."""

    def __init__(self, node: Node, map_frame: str) -> None:
        self._node, self._map_frame = node, map_frame
        self._logged, self._logged_at = "", -_SHOWN_EVERY
        self._status = node.publish("~status", str, Quality.LATCHED)
        self._markers = node.publish("~frontiers", Markers, Quality.LATCHED)

    def publish(self, status: ExploreStatus) -> None:
        """Publish a status."""
        now = self._node.now() / SECOND
        kind = f"{status.state} {status.reason if status.state != 'paused' else ''}"
        if kind != self._logged or not 0.0 <= now - self._logged_at < _SHOWN_EVERY:
            self._logged, self._logged_at = kind, now
            self._node.log.info(describe_status(status))
        self._status.send(write_status(status))

    def wait(self, reason: str) -> None:
        """Publish that the exploration waits, and the reason."""
        self.publish(ExploreStatus(reason=reason))

    def draw(self, explorer: Explorer, out: ExplorerOutputs) -> None:
        """Publish the frontiers of a step."""
        if explorer.floor is not None and self._markers.listeners():
            markers = mark_frontiers(explorer.floor, out.frontiers, out.blocked)
            self._markers.send(Markers(self._node.now(), self._map_frame, markers))
