"""What `move_base` knows of the world: frames, the newest scan, the map, and the two costmaps made from them."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np
import rospy
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import LaserScan, Range
from tf2_msgs.msg import TFMessage

from ur.source.diagnostic import UserError
from ur_nodes.navigation.costmap import Costmap
from ur_nodes.navigation.frame_history import FrameError, FrameHistory
from ur_nodes.navigation.grid_message import grid_of_message
from ur_nodes.navigation.layers import Beams, beams_of_scan
from ur_nodes.navigation.local_plan import Motion
from ur_nodes.navigation.map_costmap import MapCostmap
from ur_nodes.navigation.move_base_parameters_node import MoveBaseSettings
from ur_nodes.navigation.rolling_costmap import RollingCostmap
from ur_nodes.navigation.sonar import beams_of_range, without_walls
from ur_nodes.rosio.geometry import Pose2, pose_of_transform

_WAITING = 100  # ranges that are not worked in yet

LOCALISER_SILENCE = 3.0
"""How old (s) the newest transform from the odometry frame to the map may be."""


class WorldView:
    """Subscribes and remembers; costmaps change only in `update`, which the control loop calls."""

    def __init__(self, settings: MoveBaseSettings) -> None:
        self._settings = settings
        self.frames = FrameHistory()
        self.local = RollingCostmap(
            settings.local_side, settings.local_resolution, settings.local.reach, settings.local.inflation
        )
        self.world: MapCostmap | None = None
        self.map_problem = ""
        self._scan: LaserScan | None = None
        self._used: float | None = None
        self._new_map: OccupancyGrid | None = None
        # Transforms that nobody asks for (wheels turn all the time) are not kept.
        rospy.Subscriber("/tf_static", TFMessage, self._take_fixed, queue_size=100)
        rospy.Subscriber("/tf", TFMessage, self._take_moving, queue_size=100, tcp_nodelay=True)
        rospy.Subscriber(settings.map_topic, OccupancyGrid, self._take_map, queue_size=1)
        self._ranges: deque[Range] = deque(maxlen=_WAITING)
        if settings.local.scan:
            rospy.Subscriber(settings.local.scan.topic, LaserScan, self._take_scan, queue_size=1, tcp_nodelay=True)
        for topic in () if settings.local.scan else settings.local.sonars:
            rospy.Subscriber(topic, Range, self._ranges.append, queue_size=_WAITING, tcp_nodelay=True)

    def update(self) -> None:
        """Work a new map and the newest scan into the costmaps."""
        message, self._new_map = self._new_map, None
        if message is not None:
            self._use_map(message)
        source, scan = self._settings.local.scan, self._scan
        if source is None:
            self._lay_map()
            for _ in range(len(self._ranges)):
                self._use_range(self._ranges.popleft())
            return
        if scan is None or scan.header.stamp.to_sec() == self._used:
            return
        stamp = scan.header.stamp.to_sec()
        newest = self.frames.newest(self._settings.base_frame)
        if newest is not None and newest < stamp - 0.02 and stamp - newest < 0.2:
            return  # the odometry of that moment is still on its way
        self._used = stamp
        beams = _beams(scan, inf_is_valid=source.inf_is_valid)
        try:
            sensor = self.frames.pose(self._settings.local.frame, scan.header.frame_id, stamp)
            robot = self.frames.pose(self._settings.local.frame, self._settings.base_frame)
            self.local.update(robot, sensor, beams)
            if self.world is not None:
                self.world.update(self.frames.pose(self._settings.world.frame, scan.header.frame_id, stamp), beams)
        except FrameError:
            return

    def motion(self, sent: tuple[float, float], now: float) -> Motion | None:
        """Where the robot is by now in the odometry frame: its newest pose, carried on with the command sent."""
        try:
            pose = self.frames.pose(self._settings.local.frame, self._settings.base_frame)
            age = self.frames.age(self._settings.local.frame, self._settings.base_frame, now)
        except FrameError:
            return None
        ahead = min(max(age, 0.0), 0.1)
        return Motion(pose.compose(Pose2(sent[0] * ahead, 0.0, sent[1] * ahead)), *sent)

    def odom(self) -> Pose2 | None:
        """The map's pose in the odometry frame."""
        try:
            return self.frames.pose(self._settings.world.frame, self._settings.local.frame).inverse()
        except FrameError:
            return None

    def robot_in_map(self) -> Pose2 | None:
        """The newest pose of the robot in the map."""
        try:
            return self.frames.pose(self._settings.world.frame, self._settings.base_frame)
        except FrameError:
            return None

    def trouble(self, now: float) -> str:
        """Why the robot must not move: what is missing or too old; '' when nothing is."""
        settings = self._settings
        if self.world is None:
            return self.map_problem or f"no map on {rospy.resolve_name(settings.map_topic)}"
        if blind := self._blind(now):
            return blind
        try:
            old = self.frames.age(settings.local.frame, settings.base_frame, now)
            if old > settings.tolerance:
                return f"no odometry: {settings.base_frame} in {settings.local.frame} is {old:.1f} s old"
            old = self.frames.age(settings.world.frame, settings.local.frame, now)
            if old > LOCALISER_SILENCE:
                return f"not localised: {settings.local.frame} in {settings.world.frame} is {old:.1f} s old"
            if self._scan is not None:
                self.frames.pose(settings.base_frame, self._scan.header.frame_id)
        except FrameError as problem:
            return str(problem)
        return ""

    def _blind(self, now: float) -> str:
        """Why the scan cannot be relied on; '' also where there is none to rely on."""
        source = self._settings.local.scan
        if source is None:
            return ""
        topic = rospy.resolve_name(source.topic)
        if self._scan is None:
            return f"no scan on {topic}"
        silent = now - self._scan.header.stamp.to_sec()
        return f"no scan on {topic} for {silent:.1f} s" if silent > source.silence else ""

    def forget(self) -> None:
        """Time has begun anew: what was seen before means nothing now."""
        self.frames.forget()
        self._scan, self._used = None, None
        self._ranges.clear()
        self.local.clear()

    def costmaps(self) -> tuple[Costmap, Costmap] | None:
        """Copies of the costs of the whole map: with obstacles, and of the map alone."""
        return (self.world.frozen, self.world.static) if self.world else None

    def _use_map(self, message: OccupancyGrid) -> None:
        settings = self._settings
        try:
            grid = grid_of_message(message)
        except UserError as problem:
            self.world, self.map_problem = None, str(problem)
            rospy.logerr("%s", problem)
            return
        self.world = MapCostmap(
            grid,
            settings.world.reach,
            settings.world.inflation,
            lethal=settings.lethal,
            track_unknown=settings.track_unknown,
        )

    def _lay_map(self) -> None:
        robot, place = self._robot_in_odom(), self.odom()
        if self.world is not None and robot is not None and place is not None:
            self.local.lay(robot, self.world.static, place)

    def _use_range(self, message: Range) -> None:
        """What one sonar hears: an obstacle, unless the map has a wall there."""
        frames, local, base = self.frames, self._settings.local.frame, self._settings.base_frame
        stamp, source = message.header.stamp.to_sec(), message.header.frame_id
        newest = frames.newest(base)
        if newest is not None and newest < stamp < newest + 0.2:
            self._ranges.append(message)  # the odometry of that moment is still on its way
            return
        beams = beams_of_range(message.range, message.field_of_view, message.min_range, message.max_range)
        if self.world is None or not len(beams.angles):
            return
        try:
            sensor = frames.pose(self._settings.world.frame, source, stamp)
            beams = without_walls(beams, sensor, self.world.static)
            self.local.update(frames.pose(local, base), frames.pose(local, source, stamp), beams)
            self.world.update(sensor, beams)
        except FrameError:
            return

    def _robot_in_odom(self) -> Pose2 | None:
        try:
            return self.frames.pose(self._settings.local.frame, self._settings.base_frame)
        except FrameError:
            return None

    def _take_map(self, message: OccupancyGrid) -> None:
        self._new_map = message

    def _take_scan(self, message: LaserScan) -> None:
        self._scan = message

    def _take_fixed(self, message: TFMessage) -> None:
        self._take(message, fixed=True)

    def _take_moving(self, message: TFMessage) -> None:
        self._take(message, fixed=False)

    def _take(self, message: TFMessage, *, fixed: bool) -> None:
        for item in message.transforms:
            pose = pose_of_transform(item.transform)
            self.frames.add(item.header.frame_id, item.child_frame_id, item.header.stamp.to_sec(), pose, fixed=fixed)


def _beams(scan: Any, *, inf_is_valid: bool) -> Beams:
    return beams_of_scan(
        np.asarray(scan.ranges),
        scan.angle_min,
        scan.angle_increment,
        scan.range_min,
        scan.range_max,
        inf_is_valid=inf_is_valid,
    )
