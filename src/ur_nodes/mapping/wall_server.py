"""Walls of the map that is served: drawn, erased and restored on request, and published at once."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from ur.maps.store import own_store
from ur.maps.walls import is_restorable
from ur.maps.zones import find_home
from ur_nodes.geometry.grid import Grid
from ur_nodes.mapping.changes import attempt, change_walls, take_changes
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality


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
        take_changes(node, "wall_request", self._change)

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
