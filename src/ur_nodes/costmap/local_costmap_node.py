"""The local costmap alone: the stand-in for costmap_2d_node, of a scan and of sonars."""

from __future__ import annotations

import sys
from collections import deque
from dataclasses import dataclass

import rospy
from geometry_msgs.msg import Point32, PolygonStamped
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import LaserScan, Range

from ur_nodes.costmap.costmap import Inflation, occupancy_of_costs
from ur_nodes.costmap.footprint import Footprint
from ur_nodes.costmap.footprint_parameters_node import read_footprint
from ur_nodes.costmap.layers import Beams, Ranges, beams_of_scan, level_beams
from ur_nodes.costmap.rolling_costmap import RollingCostmap
from ur_nodes.costmap.sonar import beams_of_range
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.transform_tree import ExtrapolationError, TransformError
from ur_nodes.rosio.frames import Frames
from ur_nodes.rosio.grid_message import grid_message
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.shell import run_node

_NAME = "costmap_node"
_WAITING = 100  # messages that are not worked in yet
_PATIENCE = 10.0  # s: on a small computer a base starts later than this node
_ODOMETRY_PATIENCE = 0.5  # s for which data wait for the odometry of their time


@dataclass(frozen=True, slots=True)
class Settings:
    """The parameters below `~costmap`, under upstream's names; lengths in m, frequencies in Hz."""

    frame: str
    base_frame: str
    footprint: Footprint
    side: float
    resolution: float
    reach: Ranges
    inf_is_valid: bool
    inflation: Inflation
    scan: str
    sonars: tuple[str, ...]
    update_frequency: float
    publish_frequency: float


def read_settings(own: Parameters) -> Settings:
    """Read them. Raises UserError, which names the parameter."""
    resolution = own.number("resolution", 0.05, minimum=0.005, maximum=1.0)
    footprint = read_footprint(own, resolution)
    obstacles, slopes, sonars = own.below("obstacle_layer"), own.below("inflation_layer"), own.below("sonar_layer")
    sources = obstacles.text("observation_sources", "").split()
    if len(sources) > 1:
        obstacles.fail("observation_sources", " ".join(sources), "one name at most: this node looks at one laser")
    source = obstacles.below(sources[0] if sources else "scan")
    return Settings(
        frame=own.text("global_frame", "odom"),
        base_frame=own.text("robot_base_frame", "base_footprint"),
        footprint=footprint,
        side=max(own.number("width", 4.0, minimum=1.0), own.number("height", 4.0, minimum=1.0)),
        resolution=resolution,
        reach=Ranges(
            source.number("obstacle_range", 2.5, minimum=0.1), source.number("raytrace_range", 3.0, minimum=0.1)
        ),
        inf_is_valid=source.boolean("inf_is_valid", False),
        inflation=Inflation(
            footprint.inscribed,
            slopes.number("inflation_radius", 0.55, minimum=0.0),
            slopes.number("cost_scaling_factor", 10.0, minimum=0.1),
        ),
        scan=source.text("topic", sources[0]) if sources else "",
        sonars=sonars.texts("topics", ()),
        update_frequency=own.number("update_frequency", 5.0, minimum=0.1, maximum=50.0),
        publish_frequency=own.number("publish_frequency", 2.0, minimum=0.1, maximum=50.0),
    )


class LocalCostmap:
    """Subscribes, updates the costmap, and publishes while it has subscribers."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._frames = Frames()
        self._costmap = RollingCostmap(settings.side, settings.resolution, settings.reach, settings.inflation)
        self._waiting: deque[tuple[str, float, Beams]] = deque(maxlen=_WAITING)
        self._robot: Pose2 | None = None
        self._quiet_until = rospy.Time.now() + rospy.Duration.from_sec(_PATIENCE)
        self._grid = rospy.Publisher("~costmap/costmap", OccupancyGrid, queue_size=1)
        self._outline = rospy.Publisher("~costmap/footprint", PolygonStamped, queue_size=1)
        if settings.scan:
            rospy.Subscriber(settings.scan, LaserScan, self._take_scan, queue_size=1, tcp_nodelay=True)
        for topic in settings.sonars:
            rospy.Subscriber(topic, Range, self._take_range, queue_size=_WAITING, tcp_nodelay=True)
        rospy.Timer(rospy.Duration.from_sec(1.0 / settings.update_frequency), self._update)
        rospy.Timer(rospy.Duration.from_sec(1.0 / settings.publish_frequency), self._publish)

    def _take_scan(self, message: LaserScan) -> None:
        self._keep(message, beams_of_scan(message, inf_is_valid=self._settings.inf_is_valid))

    def _take_range(self, message: Range) -> None:
        beams = beams_of_range(message.range, message.field_of_view, message.min_range, message.max_range)
        self._keep(message, beams)

    def _keep(self, message: LaserScan | Range, beams: Beams) -> None:
        self._waiting.append((message.header.frame_id, message.header.stamp.to_sec(), beams))

    def _update(self, _event: object) -> None:
        settings = self._settings
        taken = [self._waiting.popleft() for _ in range(len(self._waiting))]
        try:
            robot = self._frames.pose(settings.frame, settings.base_frame)
        except TransformError as problem:
            self._warn(f"no costmap: {problem}")
            return
        for frame, stamp, beams in taken:
            try:
                sensor = self._frames.lookup(settings.frame, frame, stamp)
            except TransformError as problem:
                late = isinstance(problem, ExtrapolationError) and problem.ahead
                if late and rospy.get_time() - stamp < _ODOMETRY_PATIENCE:
                    self._waiting.append((frame, stamp, beams))  # the odometry of that moment has not arrived yet
                else:
                    self._warn(f"data of {frame} ignored: {problem}")
                continue
            self._costmap.update(robot, *level_beams(sensor, beams))
        self._robot = robot

    def _warn(self, text: str) -> None:
        if rospy.Time.now() > self._quiet_until:  # frames may come up later than we do
            rospy.logwarn_throttle(10.0, text)

    def _publish(self, _event: object) -> None:
        robot, now = self._robot, rospy.Time.now()
        if robot is None:
            return
        if self._grid.get_num_connections():
            costmap = self._costmap.inflated()
            grid = Grid(occupancy_of_costs(costmap.costs), costmap.resolution, costmap.origin)
            self._grid.publish(grid_message(grid, self._settings.frame, now))
        if self._outline.get_num_connections():
            message = PolygonStamped()
            message.header.frame_id, message.header.stamp = self._settings.frame, now
            message.polygon.points = [
                Point32(float(x), float(y), 0.0) for x, y in self._settings.footprint.outline_at(robot)
            ]
            self._outline.publish(message)


def start() -> None:
    """Read the parameters and begin."""
    LocalCostmap(read_settings(Parameters("~").below("costmap")))


if __name__ == "__main__":
    sys.exit(run_node(_NAME, start))
