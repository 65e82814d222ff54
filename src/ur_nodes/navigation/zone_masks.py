"""Masks of keep-out zones and speed zones, from the topics that a map server or a filter mask server publishes."""

from __future__ import annotations

from collections.abc import Callable

from ur_nodes.geometry.grid import Grid
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map


class ZoneMasks:
    """The newest masks in the map frame: `keep_out` is 100 in zones, `speed` a percentage; None before the first."""

    def __init__(self, node: Node, keep_out_topic: str, speed_topic: str, forbid: Callable[[], None]) -> None:
        """An empty topic means that there are no such zones.

        `forbid` is called when the keep-out zones have changed.
        """
        self.keep_out: Grid | None = None
        self.speed: Grid | None = None
        self._forbid = forbid
        if keep_out_topic:
            node.subscribe(keep_out_topic, Map, self._take_keep_out, Quality.LATCHED)
        if speed_topic:
            node.subscribe(speed_topic, Map, self._take_speed, Quality.LATCHED)

    def _take_keep_out(self, mask: Map) -> None:
        self.keep_out = mask.grid
        self._forbid()

    def _take_speed(self, mask: Map) -> None:
        self.speed = mask.grid
