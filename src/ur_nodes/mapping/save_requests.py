"""Requests to save maps of topics as files."""

from collections.abc import Callable
from pathlib import Path

from ur.source.diagnostic import UserError, error
from ur_nodes.mapping.map_saver import save_map
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import SaveOwnMap, SaveTopicMap
from ur_nodes.ports.values import Map, Result

PATIENCE = 5.0  # s for a map to arrive
_LONGEST = 200  # characters of a name
_ENDINGS = (".pgm", ".yaml")


class SaveRequests:
    """Serves requests to save the map of a topic, and with `own` that of this node. One map is saved at a time."""

    def __init__(self, node: Node, *, own: str = "") -> None:
        self._node = node
        self._busy = False
        node.serve_later("map_saver/save_map", SaveTopicMap, self._save)
        if own:
            node.serve_later(own, SaveOwnMap, lambda request, give: self._save(SaveTopicMap(request.name), give))

    def _save(self, request: SaveTopicMap, give: Callable[[Result], None]) -> None:
        if self._busy:
            give(self._report(request, "another map is being saved"))
            return
        self._busy, topic = True, request.topic or "map"
        received: list[Map | str] = []

        def end(problem: str) -> None:
            self._busy = False
            give(self._report(request, problem))

        def on_map(given: Map | str) -> None:
            if not received:
                received.append(given)
                subscription.close()
                self._node.work(lambda: write(request, given), end, "saving")

        def give_up() -> None:
            if not received:
                received.append("")
                subscription.close()
                end(f"no map on {self._node.resolve(topic)} for {PATIENCE:g} s; is a mapping node running?")

        subscription = self._node.subscribe(topic, Map, on_map, Quality.LATCHED, unreadable=on_map)
        self._node.after(PATIENCE, give_up, steady=True)

    def _report(self, request: SaveTopicMap, problem: str) -> Result:
        if problem:
            self._node.log.error(f"map {request.name!r} was not saved: {problem}")
        else:
            self._node.log.info(f"map saved as {request.name!r}")
        return Result(not problem, problem)


def write(request: SaveTopicMap, given: Map | str) -> str:
    """Write a map, unless it could not be read. Returns the problem, '' for none."""
    if isinstance(given, str):
        return given
    try:
        save_map(place_of(request.name, Path.home()), given.grid, request.occupied, request.free)
    except UserError as problem:
        return problem.diagnostics[0].message
    except OSError as problem:
        return f"it cannot be written: {problem.strerror}"
    return ""


def place_of(name: str, home: Path) -> Path:
    """Return the path, without suffix, of a map by the name in a request. No folder is made, and no file replaced.

    Names without a folder are below `home`. Raises UserError.
    """
    plain = name.removeprefix("file://").removesuffix(".yaml")
    path = home / plain
    usable = plain.isprintable() and 0 < len(plain) <= _LONGEST and not path.name.startswith(".")
    if not usable or ".." in path.parts or plain.endswith("/"):
        raise UserError(
            error(f"name {name[:_LONGEST]!r}, expected one as 'office' or '/home/me/office'", rule="bad-map")
        )
    if not path.parent.is_dir():
        raise UserError(error(f"there is no folder {path.parent}", rule="bad-map"))
    for ending in _ENDINGS:
        if (path.parent / f"{path.name}{ending}").exists():
            raise UserError(error(f"{path}{ending} is there already, and is not replaced", rule="bad-map"))
    return path
