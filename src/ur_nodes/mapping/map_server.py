"""A map, its zones and its walls, for all nodes."""

from __future__ import annotations

from pathlib import Path

from ur_nodes.geometry.grid import Grid
from ur_nodes.mapping.wall_server import WallServer
from ur_nodes.mapping.zone_server import ZoneServer
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap
from ur_nodes.ports.values import Map, MapInfo, Result


class MapServer:
    """Offers one grid in the frame `~frame_id` (default `map`), and the zones and walls of its file."""

    def __init__(self, node: Node, grid: Grid, file: Path) -> None:
        self._node = node
        self._frame = node.parameters.text("frame_id", "map")
        self._info = node.publish("map_metadata", MapInfo, Quality.LATCHED)
        self._maps = node.publish("map", Map, Quality.LATCHED)
        self._offer(grid)
        node.serve("static_map", AskMap, lambda _request: Result(success=True, value=self._map))
        self._zones = ZoneServer(node, file, grid, self._frame)
        self._walls = WallServer(node, file, grid, self._offer)

    def _offer(self, grid: Grid) -> None:
        now, (height, width) = self._node.now(), grid.shape
        self._map = Map(now, self._frame, grid)
        self._info.send(MapInfo(now, grid.resolution, width, height, grid.origin))
        self._maps.send(self._map)
