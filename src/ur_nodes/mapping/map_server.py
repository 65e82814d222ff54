"""A map, its zones and its walls, for all nodes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from ur.source.diagnostic import UserError
from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.mapping.save_requests import SaveRequests
from ur_nodes.mapping.wall_server import WallServer
from ur_nodes.mapping.zone_server import ZoneServer
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap, LoadMap, MapProblem
from ur_nodes.ports.values import Map, MapInfo, Result


class MapServer:
    """Serves one grid in the frame `~frame_id` (default `map`), and the zones and walls of its file."""

    def __init__(self, node: Node, grid: Grid, file: Path) -> None:
        self._node = node
        self._frame = node.parameters.text("frame_id", "map")
        self._info = node.publish("map_metadata", MapInfo, Quality.LATCHED)
        self._maps = node.publish("map", Map, Quality.LATCHED)
        self._offer(grid)
        node.serve("static_map", AskMap, lambda _request: Result(success=True, value=self._map))
        self._zones = ZoneServer(node, file, grid, self._frame)
        self._walls = WallServer(node, file, grid, self._offer)
        node.serve_later("change_map", LoadMap, self._change_map)
        self._saves = SaveRequests(node)

    def _offer(self, grid: Grid) -> None:
        now, (height, width) = self._node.now(), grid.shape
        self._map = Map(now, self._frame, grid)
        self._info.send(MapInfo(now, grid.resolution, width, height, grid.origin))
        self._maps.send(self._map)

    def _change_map(self, request: LoadMap, give: Callable[[Result], None]) -> None:
        file = Path(request.file.removeprefix("file://"))

        def take(found: Grid | Result) -> None:
            if isinstance(found, Result):
                self._node.log.error(f"another map was not loaded: {found.text}")
                give(found)
                return
            self._offer(found)
            self._zones.use(file, found)
            self._walls.use(file, found)
            self._node.log.info(f"the map is {file} from now on")
            give(Result(success=True, value=self._map))

        self._node.work(partial(read_grid, file), take, "map")


def read_grid(file: Path) -> Grid | Result:
    """Read a map file; a result without success if it cannot be used."""
    if not file.is_absolute():
        return Result(False, f"file {str(file)!r}, expected an absolute path", MapProblem.UNUSABLE)
    if not file.is_file():
        return Result(False, f"there is no file {file}", MapProblem.MISSING)
    try:
        return load_map(file)
    except UserError as problem:
        return Result(False, problem.diagnostics[0].message, MapProblem.UNUSABLE)
