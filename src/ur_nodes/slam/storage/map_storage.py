"""Stores the map of a mapping node: every few seconds, on request, and at the end."""

import os
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, replace

from ur.maps.names import check_map_name, fresh_name
from ur.maps.store import PICTURE, own_store
from ur_nodes.geometry.grid import Grid
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result
from ur_nodes.slam.gmapping.map_output import GridMapOutput
from ur_nodes.slam.gmapping.slam import Slam
from ur_nodes.slam.map_state import MapState
from ur_nodes.slam.storage.writer import MapWriter, load_poses, pause_before_next

SILENCE = 30.0  # s between two reports of the same problem
_END_LIMIT = 60.0  # s for the map to be written at the end


@dataclass(frozen=True, slots=True)
class StorageSettings:
    """`name` of the map, '' for one that no map has; `every` (s) it is written; `robot` is who makes it.

    `latest`: the name `latest` then refers to this map.
    """

    name: str
    every: float
    robot: str
    latest: bool


def read_storage_settings(parameters: Parameters) -> StorageSettings | None:
    """Read the settings; None where the map is not to be stored. Raises UserError."""
    if not parameters.boolean("store", False):
        return None
    name = parameters.text("map_name", "")
    return StorageSettings(
        check_map_name(name) if name else "",
        parameters.number("save_every", 5.0, minimum=0.5, maximum=3600.0),
        parameters.text("robot", ""),
        parameters.boolean("latest", False),
    )


class MapStorage:
    """Holds the claim on a stored map until the node ends, and offers the service `~save`.

    `continues`: the map has been stored before.
    """

    def __init__(self, node: Node, settings: StorageSettings, output: GridMapOutput) -> None:
        """Claim the map. Raises UserError: another program changes it."""
        self._node, self._settings, self._output = node, settings, output
        self._store = own_store(os.environ)
        self.name = settings.name or fresh_name(time.strftime("%Y-%m-%d"), self._folders())
        self._claims = ExitStack()
        self._claims.enter_context(self._store.claim(self.name))
        record = self._store.record(self.name)
        self.continues = (self._store.path(self.name) / PICTURE).is_file()
        self._writer = MapWriter(self._store.path(self.name), replace(record, robot=settings.robot or record.robot))
        self._saved: MapState | None = None
        self._is_latest = False
        self._report_due = 0.0

    def begin(self, slam: Slam) -> None:
        """Start to store; a map that was stored before is continued. Raises UserError if that is impossible."""
        node, name, every = self._node, self.name, self._settings.every
        if self.continues:
            slam.restore(MapState(*load_poses(self._store.path(name), self._writer.record)))
            self._saved = slam.state()
            node.log.info(f"continuing the map '{name}'; looking for the place on it")
            self._output.publish()
        node.serve_later("~save", Trigger, self._answer)
        node.on_end(lambda: self._save(self._report_end), within=_END_LIMIT)
        node.after(every, self._save_again, steady=True)
        node.log.info(f"saving the map as '{name}', every {every:g} s and at the end")

    def _save(self, callback: Callable[[str], None]) -> None:
        """Write the map if it has changed; `callback` gets the reason of a failure, '' on success."""

        def compare(state: MapState) -> None:
            if not state.poses or _same(state, self._saved):
                callback("")
            else:
                self._output.draw(state, lambda grid: write(state, grid))

        def write(state: MapState, grid: Grid) -> None:
            self._node.work(lambda: self._write(state, grid), lambda problem: end(state, problem), "storage")

        def end(state: MapState, problem: str) -> None:
            if not problem:
                self._saved = state
            callback(problem)

        self._output.state(compare)

    def _write(self, state: MapState, grid: Grid) -> str:
        try:
            self._writer.write(grid, state.poses, state.edges, state.scans)
            if self._settings.latest and not self._is_latest:
                self._store.set_latest(self.name)
                self._is_latest = True
        except OSError as problem:
            return f"{problem.filename or self._store.path(self.name)}: {problem.strerror or problem}"
        return ""

    def _folders(self) -> list[str]:
        try:
            return [each.name for each in self._store.folder.iterdir()]
        except OSError:
            return []

    def _save_again(self) -> None:
        began = self._node.steady()

        def end(problem: str) -> None:
            now = self._node.steady()
            if problem and now > self._report_due:
                self._report_due = now + SILENCE
                self._node.log.error(f"the map cannot be written: {problem}; is the disk full?")
            self._node.after(pause_before_next(self._settings.every, now - began), self._save_again, steady=True)

        self._save(end)

    def _answer(self, _request: Trigger, give: Callable[[Result], None]) -> None:
        def end(problem: str) -> None:
            if not problem and self._saved is None:
                problem = "there is no map yet; is the lidar driver running?"
            give(Result(not problem, problem or self.name))

        self._save(end)

    def _report_end(self, problem: str) -> None:
        name, log = self.name, self._node.log
        self._claims.close()
        if problem:
            log.error(f"the map cannot be written: {problem}")
        elif self._saved is not None:
            log.info(f"map '{name}' saved; navigate on it with: ur run keyboard_navigate map:={name}")


def _same(state: MapState, saved: MapState | None) -> bool:
    if saved is None or len(state.scans) != len(saved.scans) or list(state.poses) != list(saved.poses):
        return False
    return all(one is other for one, other in zip(state.scans, saved.scans, strict=True))
