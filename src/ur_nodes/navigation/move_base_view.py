"""Displays of `move_base`: costmaps, paths, footprints. Topics without subscribers cost nothing."""

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.costmap import Costmap, occupancy_of_costs
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.move_base_settings import MoveBaseSettings
from ur_nodes.navigation.planning.path_geometry import headings
from ur_nodes.navigation.world_view import WorldView
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map, MapUpdate, Outline, Path, StampedPose


class MoveBaseView:
    """Publishers under the names of upstream's navfn and dwa_local_planner."""

    def __init__(self, node: Node, settings: MoveBaseSettings, world: WorldView) -> None:
        self._node = node
        self._settings = settings
        self._world = world
        self._world_frame = settings.world.frame
        self._local_frame = settings.local.frame
        self._maps_shown = 0
        self._arrived = False  # a subscriber of the global costmap
        self._global = node.publish("~global_costmap/costmap", Map, on_subscriber=self._on_subscriber)
        self._changes = node.publish("~global_costmap/costmap_updates", MapUpdate, on_subscriber=self._on_subscriber)
        self._local = node.publish("~local_costmap/costmap", Map)
        self._footprint = node.publish("~global_costmap/footprint", Outline)
        self._local_footprint = node.publish("~local_costmap/footprint", Outline)
        self._plan = node.publish("~NavfnROS/plan", Path)
        self._followed = node.publish("~DWAPlannerROS/global_plan", Path)
        self._foreseen = node.publish("~DWAPlannerROS/local_plan", Path)
        self._goal = node.publish("~current_goal", StampedPose, Quality.LATCHED)

    def show_goal(self, goal: Pose2) -> None:
        """Publish the goal that is now pursued, in the map."""
        self._goal.send(StampedPose(self._node.now(), self._world_frame, goal))

    def show_plan(self, points: NDArray[np.float64]) -> None:
        """Publish a new path (n, 2) in the map."""
        self._plan.send(make_path(points, self._world_frame, self._node.now()))

    def show_drive(self, path: NDArray[np.float64] | None, ahead: NDArray[np.float64] | None) -> None:
        """Publish the rest of the path (n, 2) in the map, and the robot's next poses (t, 3) in the odometry frame."""
        now = self._node.now()
        if path is not None and len(path) and self._followed.subscribers():
            self._followed.send(make_path(path, self._world_frame, now))
        if ahead is not None and self._foreseen.subscribers():
            self._foreseen.send(make_path(ahead, self._local_frame, now))

    def show_surroundings(self, tick: int) -> None:
        """Publish the costmaps and footprints that are due in control period `tick`."""
        outline_at, now = self._settings.footprint.outline_at, self._node.now()
        if self._is_due(self._settings.local.publish_frequency, tick):
            robot = self._world.robot_in_odom()
            if self._local.subscribers():
                self._local.send(Map(now, self._local_frame, grid_of(self._world.local_costmap.inflated())))
            if robot is not None and self._local_footprint.subscribers():
                self._local_footprint.send(Outline(now, self._local_frame, outline_at(robot)))
        if self._is_due(self._settings.world.publish_frequency, tick):
            robot = self._world.robot_in_map()
            self._show_global_costmap(now)
            if robot is not None and self._footprint.subscribers():
                self._footprint.send(Outline(now, self._world_frame, outline_at(robot)))

    def _is_due(self, frequency: float, tick: int) -> bool:
        return frequency > 0.0 and tick % max(1, round(1.0 / (frequency * self._settings.navigator.period))) == 0

    def _on_subscriber(self) -> None:
        """Note a new subscriber. Of changes, too: it may have missed some since it received the whole."""
        self._arrived = True

    def _show_global_costmap(self, now: int) -> None:
        """Publish the whole costmap when it or a subscriber is new, as costmap_2d does; else the change."""
        layered = self._world.global_costmap
        if layered is None or not self._global.subscribers():
            return
        changed = layered.pop_changes()
        new, self._maps_shown = self._maps_shown != self._world.maps, self._world.maps
        if new or self._arrived:
            self._arrived = False
            self._global.send(Map(now, self._world_frame, grid_of(layered.costmap)))
        elif changed is not None and self._changes.subscribers():
            values = occupancy_of_costs(layered.costmap.costs[changed])
            self._changes.send(MapUpdate(now, self._world_frame, changed[0].start, changed[1].start, values))


def grid_of(costmap: Costmap) -> Grid:
    """Convert a costmap to an occupancy grid, 0 to 100."""
    return Grid(occupancy_of_costs(costmap.costs), costmap.resolution, costmap.origin)


def make_path(points: NDArray[np.float64], frame: str, stamp: int) -> Path:
    """Make a path of points (n, 2), heading along it, or of poses (n, 3)."""
    poses = points if points.shape[1] == 3 else np.column_stack((points, headings(points)))
    return Path(stamp, frame, poses)
