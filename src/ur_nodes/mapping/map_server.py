"""A map, its zones and its walls, for all nodes."""

import json
import os
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from ur.maps.store import own_store
from ur.maps.walls import is_restorable
from ur.maps.zones import find_home
from ur.source.diagnostic import UserError
from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.mapping.changes import attempt, change_walls, subscribe_changes
from ur_nodes.mapping.zone_server import ZoneServer
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap, LoadMap, MapProblem
from ur_nodes.ports.values import Map, MapInfo, Result


class WallServer:
    """Changes the walls of a stored map; `use` takes the new one. Maps that are files of others stay as they are.

    `walls` (JSON) has the `name` of the map ('': it cannot be changed), whether the last change is `restorable`, and
    the `answer` to the last request on `wall_request`: {"id": text, "map": name, "do": "draw", "strokes": [edit, ...]}
    or "do": "restore".
    """

    def __init__(self, node: Node, map_file: Path, grid: Grid, use: Callable[[Grid], None]) -> None:
        self._node, self._use = node, use
        self._status = node.publish("walls", str, Quality.LATCHED)
        self.use(map_file, grid)
        subscribe_changes(node, "wall_request", self._change)

    def use(self, map_file: Path, grid: Grid) -> None:
        """Serve changes of the walls of this map from now on."""
        self._store, name = find_home(map_file, os.environ)
        self._name, self._grid = name if self._store == own_store(os.environ) else "", grid
        self._publish(self._is_restorable(), None)

    def _is_restorable(self) -> bool:
        return bool(self._name) and is_restorable(self._store, self._name)

    def _change(self, request: Mapping[str, object]) -> None:
        # Changes keep the cells' frame, so that the first grid stands for all.
        change, before = partial(change_walls, self._store, self._name, self._grid, request), self._grid

        def job() -> tuple[Grid | None, str, bool]:
            return *attempt(change, "the map"), self._is_restorable()

        self._node.work(job, partial(self._finish, str(request["id"]), before), "walls")

    def _finish(self, id: str, before: Grid, outcome: tuple[Grid | None, str, bool]) -> None:
        grid, problem, restorable = outcome
        if grid is not None and before is self._grid:  # else another map has been loaded
            self._use(grid)
            self._node.log.info(f"walls of map {self._name} were changed on request")
        self._publish(restorable, {"id": id, "problem": problem})

    def _publish(self, restorable: bool, answer: dict[str, str] | None) -> None:
        value = {"name": self._name, "restorable": restorable, "answer": answer}
        self._status.send(json.dumps(value, separators=(",", ":")))


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

    def _offer(self, grid: Grid) -> None:
        now, (height, width) = self._node.now(), grid.shape
        self._map = Map(now, self._frame, grid)
        self._info.send(MapInfo(now, grid.resolution, width, height, grid.origin))
        self._maps.send(self._map)

    def _change_map(self, request: LoadMap, give: Callable[[Result], None]) -> None:
        file = Path(request.file.removeprefix("file://"))

        def on_found(found: Grid | Result) -> None:
            if isinstance(found, Result):
                self._node.log.error(f"another map was not loaded: {found.text}")
                give(found)
                return
            self._offer(found)
            self._zones.use(file, found)
            self._walls.use(file, found)
            self._node.log.info(f"the map is {file} from now on")
            give(Result(success=True, value=self._map))

        self._node.work(partial(read_grid, file), on_found, "map")


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
