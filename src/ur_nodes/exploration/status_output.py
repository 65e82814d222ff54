"""The outputs of an exploration: its status, log lines and frontiers as markers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ur_nodes.exploration.explorer import Explorer
from ur_nodes.exploration.explorer_step import ExplorerOutputs
from ur_nodes.exploration.search.floor import Floor
from ur_nodes.exploration.search.frontiers import Frontier
from ur_nodes.exploration.status import ExploreStatus, describe_status, write_status
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Marker, Markers

_SHOWN_EVERY = 10.0  # s between two lines in the log
_LEFT, _GIVEN_UP = (0.0, 0.0, 1.0, 1.0), (1.0, 0.0, 0.0, 1.0)
_SIZE = (0.1, 0.1, 0.0)


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
        if explorer.floor is not None and self._markers.subscribers():
            markers = mark_frontiers(explorer.floor, out.frontiers, out.blocked)
            self._markers.send(Markers(self._node.now(), self._map_frame, markers))


def mark_frontiers(floor: Floor, frontiers: Sequence[Frontier], blocked: Sequence[Frontier]) -> tuple[Marker, ...]:
    """Return all frontiers as points, in the colours of upstream's `explore_lite`: red are given up or left out."""
    origin = Pose2(0.0, 0.0, 0.0).in_space()
    coloured = [(each, _LEFT) for each in frontiers] + [(each, _GIVEN_UP) for each in blocked]
    return tuple(
        Marker("frontiers", number, "points", origin, _SIZE, colour, "", _points(floor, each))
        for number, (each, colour) in enumerate(coloured)
    )


def _points(floor: Floor, frontier: Frontier) -> np.ndarray:
    points = floor.points_of_cells(frontier.cells)
    return np.column_stack((points, np.zeros(len(points))))
