"""Draws the map of a mapping node, publishes it, and serves it on request."""

from collections.abc import Callable, Sequence

from ur_nodes.geometry.difference import describe_poses
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap
from ur_nodes.ports.values import Map, MapInfo, Result
from ur_nodes.slam.gmapping.settings import GmappingSettings
from ur_nodes.slam.gmapping.slam import Slam
from ur_nodes.slam.map_state import MapState
from ur_nodes.slam.occupancy import OccupancyMap

SCANS = "scans"
"""The lane of all that uses the mapper."""

_DRAWING = "map"


class GridMapOutput:
    """The topics `map` and `map_metadata`, latched, and the service `dynamic_map`. Drawing never delays a scan."""

    def __init__(self, node: Node, settings: GmappingSettings, slam: Slam) -> None:
        self._node, self._settings, self._slam = node, settings, slam
        self._busy = False
        self._drawn = OccupancyMap(settings.delta, settings.occ_thresh, settings.max_usable or float("inf"))
        if settings.edges:
            self._drawn.include(settings.edges[:2], settings.edges[2:])
        self._map = node.publish("map", Map, Quality.LATCHED)
        self._info = node.publish("map_metadata", MapInfo, Quality.LATCHED)
        node.serve_later("dynamic_map", AskMap, self._answer)
        self._timer = node.every(settings.map_update_interval, self.publish)

    def use(self, settings: GmappingSettings) -> None:
        """Use changed settings, and publish at once."""
        self._settings = settings
        self._drawn.threshold = settings.occ_thresh
        self._timer.cancel()
        self._timer = self._node.every(settings.map_update_interval, self.publish)
        self.publish()

    def publish(self) -> None:
        """Draw the changes, and publish the map; nothing is published before the first keyframe."""
        if not self._busy:
            self._busy = True
            self._picture(self._publish)

    def describe(self, poses: Sequence[Pose2]) -> None:
        """Log what would distinguish places on the map."""

        def compare(grid: Grid) -> None:
            text = "drive to another room"
            self._node.work(lambda: describe_poses(grid, poses, text), self._node.log.warn, _DRAWING)

        self.state(lambda state: self.draw(state, compare))

    def state(self, callback: Callable[[MapState], None]) -> None:
        """Pass the present map to `callback`."""
        self._node.work(self._slam.state, callback, SCANS)

    def draw(self, state: MapState, callback: Callable[[Grid], None]) -> None:
        """Pass the picture of a map with at least one keyframe to `callback`."""
        self._node.work(lambda: self._draw(state), callback, _DRAWING)

    def _picture(self, callback: Callable[[Grid | None], None]) -> None:
        self.state(lambda state: self.draw(state, callback) if state.poses else callback(None))

    def _draw(self, state: MapState) -> Grid:
        self._drawn.update(state.poses, state.scans, state.drives)
        return self._drawn.grid()

    def _publish(self, grid: Grid | None) -> None:
        self._busy = False
        if grid:
            now = self._node.now()
            self._map.send(Map(now, self._settings.map_frame, grid))
            self._info.send(MapInfo(now, grid.resolution, grid.width, grid.height, grid.origin))

    def _answer(self, _request: AskMap, give: Callable[[Result], None]) -> None:
        missing = Result(False, "there is no map yet; is the lidar driver running?")
        frame = self._settings.map_frame
        self._picture(lambda grid: give(Result(True, value=Map(self._node.now(), frame, grid)) if grid else missing))
