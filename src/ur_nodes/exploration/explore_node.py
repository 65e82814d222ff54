"""The node `explore`: drives a robot over a map that grows until it is complete. Stands in for `explore_lite`."""

import sys
from collections.abc import Callable, Sequence

import numpy as np

from ur.maps.names import is_map_name
from ur_nodes.exploration.explorer import Explorer
from ur_nodes.exploration.explorer_step import ExplorerInputs, ExplorerOutputs, ExploreSettings, read_settings
from ur_nodes.exploration.navigation import ExplorationNavigation
from ur_nodes.exploration.obstacles import Obstacles
from ur_nodes.exploration.search.floor import Floor
from ur_nodes.exploration.search.frontiers import Frontier
from ur_nodes.exploration.status import ExploreStatus, describe_status, write_status
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Map, Marker, Markers, Result
from ur_nodes.run import run

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


_AGAIN = 5.0  # s of this computer until a map that is not stored is saved again
_ANSWER_LIMIT = 60.0  # s
_MOST_SAVES = 4  # at the end
_LOGGED_EVERY = 10.0  # s


class MapSaveClient:
    """Asks a service that answers the map's name; without a service ('') no map has a name."""

    def __init__(self, node: Node, service: str) -> None:
        self._node, self._service = node, service
        self._saved = ""
        self._next = 0.0  # by node.steady

    def save_once(self) -> str:
        """Store the map for the first time, unless it is stored. Returns its name, '' while it has none."""
        if self._service and not self._saved and self._node.steady() >= self._next:
            self._next = self._node.steady() + _AGAIN
            self._ask(self._note)
        return self._saved

    def save_last(self, callback: Callable[[str], None]) -> None:
        """Save the final map; `callback` gets its name, '' if it cannot be saved."""
        left = _MOST_SAVES if self._service else 0

        def save() -> None:
            nonlocal left
            left -= 1
            self._ask(note) if left >= 0 else callback("")

        def note(name: str) -> None:
            if name:
                callback(name)
            else:
                self._node.after(_AGAIN, save, steady=True)

        save()

    def _note(self, name: str) -> None:
        self._saved = self._saved or name

    def _ask(self, callback: Callable[[str], None]) -> None:
        def read(answer: Result) -> None:
            if not answer.success:
                self._node.log.warn(f"{self._service}: the map is not saved: {answer.text}", every=_LOGGED_EVERY)
            callback(answer.text if answer.success and is_map_name(answer.text) else "")

        self._node.call(self._service, Trigger(), read, _ANSWER_LIMIT)


_POLL = 0.1  # s between two looks at what has happened


class ExploreNode:
    """Connects an Explorer to topics. At its end the last status stays published."""

    def __init__(self, node: Node) -> None:
        self._node, self._settings = node, node.parameters.follow(read_settings, self._change)
        self._explorer = Explorer(self._settings.explorer)
        self._grid: Grid | None = None
        self._version, self._due, self._paused, self._busy = 0, 0.0, "", False
        self._output = StatusOutput(node, self._settings.map_frame)
        self._navigation = ExplorationNavigation(node, self._settings)
        self._saver = MapSaveClient(node, self._settings.save_service)
        self._obstacles = Obstacles(node, self._settings.costmap, self._settings.costmap_updates)
        node.subscribe("map", Map, self._on_map, Quality.LATCHED)
        self._poll = node.every(_POLL, self._look)

    def _change(self, settings: ExploreSettings) -> None:
        self._settings = settings
        self._explorer.settings = settings.explorer

    def _look(self) -> None:
        settings, now = self._settings, self._node.now() / SECOND
        robot = self._node.transforms.find_planar(settings.map_frame, settings.base_frame)
        if self._grid is None:
            self._output.wait(f"no map on {self._node.resolve('map')}; is a mapping node running?")
        elif robot is None:
            self._output.wait(f"no transform from {settings.base_frame} to {settings.map_frame}")
        elif not self._navigation.ready():
            self._output.wait(f"no action {self._node.resolve(settings.navigation)}")
        elif not self._busy:
            if now < self._due - settings.period:  # time was reset
                self._due = now
            end, pause = self._navigation.pop_end(), self._navigation.pause(now)
            if now < self._due and end is None and bool(pause) == bool(self._paused):
                return
            self._paused, self._due, self._busy = pause, now + settings.period, True
            seen = ExplorerInputs(now, self._grid, self._version, robot, self._obstacles.points(), end, pause)
            self._node.work(lambda: self._explorer.step(seen), self._obey)

    def _obey(self, out: ExplorerOutputs) -> None:
        """Carry out the explorer's commands."""
        self._busy = False
        if out.cancel:
            self._navigation.cancel()
        if out.clear:
            self._navigation.clear()
        if out.goal is not None:
            self._navigation.send(out.goal)
        self._output.draw(self._explorer, out)
        if out.status.ended:
            self._poll.cancel()
            self._saver.save_last(lambda saved: self._output.publish(out.status.with_map(saved)))
        else:
            self._output.publish(out.status.with_map(self._saver.save_once()))

    def _on_map(self, given: Map) -> None:
        self._grid = given.grid
        self._version += 1


if __name__ == "__main__":
    sys.exit(run("explore", ExploreNode))
