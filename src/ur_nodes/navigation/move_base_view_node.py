"""Displays of `move_base`: costmaps, paths, footprints. Topics without subscribers cost nothing."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any

import rospy
from geometry_msgs.msg import Point32, PolygonStamped, PoseStamped
from nav_msgs.msg import OccupancyGrid, Path
from numpy.typing import NDArray

from ur_nodes.costmap.costmap import Costmap, occupancy_of_costs
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.move_base_parameters_node import MoveBaseSettings
from ur_nodes.navigation.planning.path_geometry import headings
from ur_nodes.navigation.world_view_node import WorldView
from ur_nodes.rosio.geometry import pose_message
from ur_nodes.rosio.grid_message import grid_message
from ur_nodes.rosio.grid_update import GridUpdate, update_message


class MoveBaseView:
    """Publishers under the names of upstream's navfn and dwa_local_planner."""

    def __init__(self, settings: MoveBaseSettings, world: WorldView) -> None:
        self._settings = settings
        self._world = world
        self._world_frame = settings.world.frame
        self._local_frame = settings.local.frame
        self._maps_shown = 0
        self._arrivals = _Arrivals()
        self._costmaps = {
            False: rospy.Publisher(
                "~global_costmap/costmap", OccupancyGrid, queue_size=1, subscriber_listener=self._arrivals
            ),
            True: _publisher("~local_costmap/costmap", OccupancyGrid),
        }
        self._changes = rospy.Publisher(
            "~global_costmap/costmap_updates", GridUpdate, queue_size=1, subscriber_listener=self._arrivals
        )
        self._footprints = {
            False: _publisher("~global_costmap/footprint", PolygonStamped),
            True: _publisher("~local_costmap/footprint", PolygonStamped),
        }
        self._plan = _publisher("~NavfnROS/plan", Path)
        self._followed = _publisher("~DWAPlannerROS/global_plan", Path)
        self._foreseen = _publisher("~DWAPlannerROS/local_plan", Path)
        self._goal = _publisher("~current_goal", PoseStamped, latch=True)

    def show_goal(self, goal: Pose2) -> None:
        """The goal that is pursued from now on, in the map."""
        message = PoseStamped(pose=pose_message(goal))
        message.header.frame_id, message.header.stamp = self._world_frame, rospy.Time.now()
        self._goal.publish(message)

    def show_plan(self, points: NDArray[Any]) -> None:
        """Publish a new path (n, 2) in the map."""
        self._plan.publish(path_message(points, self._world_frame))

    def show_drive(self, path: NDArray[Any] | None, ahead: NDArray[Any] | None) -> None:
        """Publish the rest of the path (n, 2) in the map, and the robot's next poses (t, 3) in the odometry frame."""
        if path is not None and len(path) and self._followed.get_num_connections():
            self._followed.publish(path_message(path, self._world_frame))
        if ahead is not None and self._foreseen.get_num_connections():
            self._foreseen.publish(path_message(ahead, self._local_frame))

    def show_surroundings(self, tick: int, lock: AbstractContextManager[Any]) -> None:
        """Publish the costmaps and footprints that are due in control period `tick`; costmaps change under `lock`."""
        if self._is_due(self._settings.local.publish_frequency, tick):
            robot = self._world.robot_in_odom()
            if self._costmaps[True].get_num_connections():
                self._show_costmap(self._world.local_costmap.inflated(), local=True)
            if robot is not None:
                self._show_footprint(robot, local=True)
        if self._is_due(self._settings.world.publish_frequency, tick):
            robot = self._world.robot_in_map()
            self._show_global_costmap(lock)
            if robot is not None:
                self._show_footprint(robot, local=False)

    def _is_due(self, frequency: float, tick: int) -> bool:
        return frequency > 0.0 and tick % max(1, round(1.0 / (frequency * self._settings.navigator.period))) == 0

    def _show_global_costmap(self, lock: AbstractContextManager[Any]) -> None:
        """Publish the whole costmap when it is new or somebody subscribed, as costmap_2d does; else the change."""
        layered = self._world.global_costmap
        if layered is None or not self._costmaps[False].get_num_connections():
            return
        with lock:
            changed = layered.take_changes()
        new, self._maps_shown = self._maps_shown != self._world.maps, self._world.maps
        if new or self._arrivals.came:
            self._arrivals.came = False
            self._show_costmap(layered.costmap, local=False)
        elif changed is not None and self._changes.get_num_connections():
            values = occupancy_of_costs(layered.costmap.costs[changed])
            corner = changed[0].start, changed[1].start
            self._changes.publish(update_message(values, *corner, self._world_frame, rospy.Time.now()))

    def _show_costmap(self, costmap: Costmap, *, local: bool) -> None:
        frame = self._local_frame if local else self._world_frame
        grid = Grid(occupancy_of_costs(costmap.costs), costmap.resolution, costmap.origin)
        self._costmaps[local].publish(grid_message(grid, frame, rospy.Time.now()))

    def _show_footprint(self, pose: Pose2, *, local: bool) -> None:
        """Publish the robot's outline at its pose."""
        frame = self._local_frame if local else self._world_frame
        if not self._footprints[local].get_num_connections():
            return
        message = PolygonStamped()
        message.header.frame_id, message.header.stamp = frame, rospy.Time.now()
        outline = self._settings.footprint.outline_at(pose)
        message.polygon.points = [Point32(float(x), float(y), 0.0) for x, y in outline]
        self._footprints[local].publish(message)


class _Arrivals(rospy.SubscribeListener):  # type: ignore[misc]  # rospy has no types
    """Notes that a subscriber came. Of changes, too: it may have missed some since it received the whole."""

    def __init__(self) -> None:
        super().__init__()
        self.came = False

    def peer_subscribe(self, *_: object) -> None:
        """See rospy.SubscribeListener."""
        self.came = True


def path_message(points: NDArray[Any], frame: str) -> Path:
    """A nav_msgs/Path of points (n, 2), heading along the path, or poses (n, 3)."""
    message = Path()
    message.header.frame_id, message.header.stamp = frame, rospy.Time.now()
    yaws = points[:, 2] if points.shape[1] == 3 else headings(points)
    for (x, y), yaw in zip(points[:, :2].tolist(), yaws.tolist(), strict=True):
        stamped = PoseStamped(header=message.header, pose=pose_message(Pose2(x, y, yaw)))
        message.poses.append(stamped)
    return message


def _publisher(name: str, kind: Any, *, latch: bool = False) -> Any:
    return rospy.Publisher(name, kind, queue_size=1, latch=latch)
