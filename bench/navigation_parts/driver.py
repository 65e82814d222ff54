"""Sends goals, watches the robot against the truth, and puts obstacles in its way."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from dataclasses import dataclass
from typing import Any

import actionlib
import numpy as np
import rospy
from actionlib_msgs.msg import GoalStatus
from bench.navigation_parts.geodesic import free_cells, length_of, shortest_path
from bench.navigation_parts.worlds import Goal, passage_radius
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry
from nav_msgs.srv import SetMap, SetMapRequest
from numpy.typing import NDArray
from std_msgs.msg import Int32
from tf2_msgs.msg import TFMessage

from ur.robot.base import Base
from ur_nodes.codecs.geometry import pose3_of_transform, pose_message, pose_of_message
from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.grid import OCCUPIED, Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.geometry.transform_tree import TransformError, TransformTree

_SAME = Pose2(0.0, 0.0, 0.0)
FRAMES = ("odom", "base_footprint")


@dataclass(frozen=True, slots=True)
class Drive:
    """One goal: lengths in m, time in s, final error in m and degrees, localisation errors along the way in m."""

    reached: bool
    text: str
    shortest: float
    length: float
    seconds: float
    error: float
    turn_error: float
    errors: tuple[float, ...]


class Driver:
    """A client of move_base that knows the truth.

    `grid` is the world's; `map_pose` is the pose of the frame `map` in the world, and all else is in that of the world.
    """

    def __init__(
        self,
        grid: Grid,
        base: Base,
        base_frame: str = "base_footprint",
        map_pose: Pose2 = _SAME,
    ) -> None:
        self._grid = grid
        self._map = map_pose
        self._free = free_cells(grid, passage_radius(footprint_of_outline(base.footprint, grid.resolution)))
        self._base = base_frame
        self._lock = threading.Lock()
        self._frames = TransformTree()
        self._waiting: deque[tuple[float, Pose2]] = deque(maxlen=200)
        self._errors: list[float] = []
        self._last: Pose2 | None = None
        self._length = 0.0
        self.truth: Pose2 | None = None
        self.collisions: int | None = None
        self._client = actionlib.SimpleActionClient("move_base", MoveBaseAction)
        rospy.Subscriber("/tf", TFMessage, self._take_tf, queue_size=200)
        rospy.Subscriber("base_pose_ground_truth", Odometry, self._take_truth, queue_size=50)
        rospy.Subscriber("simulator/collisions", Int32, self._take_collisions, queue_size=1)

    def ready(self) -> bool:
        """Whether move_base is there and the robot is localised."""
        with self._lock:
            localised = bool(self._frames.chain("map", self._base))
        return localised and self.truth is not None and self._client.wait_for_server(rospy.Duration(0.1))

    def drive(self, goal: Goal, obstacle: str = "", limit: float = 180.0) -> Drive:
        """Send one goal and wait for its end, at most `limit` s of ROS time. `obstacle` comes in the way."""
        assert self.truth is not None
        with self._lock:
            self._errors, self._length, self._last = [], 0.0, self.truth
            start = self.truth
        way = shortest_path(self._grid, self._free, (start.x, start.y), goal[:2])
        if way is None:
            raise SystemExit(f"error: goal {goal}: there is no way to it, expected goals that can be reached")
        began = rospy.get_time()
        message = MoveBaseGoal()
        message.target_pose.header.frame_id = "map"
        message.target_pose.header.stamp = rospy.Time.now()
        target = Pose2(goal[0], goal[1], math.radians(goal[2]))
        message.target_pose.pose = pose_message(self._map.inverse().compose(target))
        done = threading.Event()
        self._client.send_goal(message, done_cb=lambda *_: done.set())
        if obstacle:
            self._place_obstacle(obstacle, way)
        ended = _wait(done, began + limit)
        seconds = rospy.get_time() - began
        if not ended:
            self._client.cancel_goal()
            done.wait(5.0)
        time.sleep(0.4)  # let the truth catch up with a robot that has stopped
        with self._lock:
            errors, length, here = tuple(self._errors), self._length, self.truth
        return Drive(
            reached=ended and self._client.get_state() == GoalStatus.SUCCEEDED,
            text=self._client.get_goal_status_text() if ended else f"not there after {limit:.0f} s",
            shortest=length_of(way),
            length=length,
            seconds=seconds,
            error=math.hypot(here.x - target.x, here.y - target.y),
            turn_error=math.degrees(abs(wrap_angle(here.yaw - target.yaw))),
            errors=errors,
        )

    def _place_obstacle(self, name: str, way: NDArray[np.float64]) -> None:
        place = self._obstacle_place(way)
        request = SetMapRequest()
        request.map.header.frame_id = name
        request.initial_pose.header.frame_id = "map"
        request.initial_pose.pose.pose = pose_message(Pose2(*place, 0.0))
        rospy.ServiceProxy("simulator/place", SetMap)(request)
        print(f"    {name} appears at ({place[0]:.2f}, {place[1]:.2f})")

    def _obstacle_place(self, way: NDArray[np.float64], size: float = 0.3) -> tuple[float, float]:
        """A place on the shortest way where there is still a way round, wide enough to drive (0.3 m either side)."""
        along = np.concatenate(((0.0,), np.cumsum(np.hypot(*np.diff(way, axis=0).T))))
        for place in np.arange(min(3.0, along[-1] / 2), along[-1] - 1.0, 0.25):
            x, y = (float(np.interp(place, along, way[:, k])) for k in (0, 1))
            values = self._grid.values.copy()
            cells = self._grid.points_of_cells(np.moveaxis(np.indices(values.shape), 0, -1))
            values[(abs(cells[..., 0] - x) < size / 2) & (abs(cells[..., 1] - y) < size / 2)] = OCCUPIED
            blocked = Grid(values, self._grid.resolution, self._grid.origin)
            start, end = tuple(way[0].tolist()), tuple(way[-1].tolist())
            other = shortest_path(blocked, free_cells(blocked, 0.3), start, end)
            if other is not None and length_of(other) < along[-1] + 3.0:
                return x, y
        raise SystemExit("error: no place for an obstacle that leaves a way round")

    def _take_tf(self, message: TFMessage) -> None:
        with self._lock:
            for item in message.transforms:
                frames = item.header.frame_id, item.child_frame_id
                self._frames.add(*frames, item.header.stamp.to_sec(), pose3_of_transform(item.transform))
            self._compare()

    def _compare(self) -> None:
        """Where the newest map -> odom says the robot was, for each truth whose odometry has come."""
        while self._waiting:
            stamp, truth = self._waiting[0]
            newest = self._frames.newest(self._base)
            if newest is None or newest < stamp:
                return
            self._waiting.popleft()
            try:
                correction = self._map.compose(self._frames.pose("map", "odom"))
                told = correction.compose(self._frames.pose("odom", self._base, stamp))
            except TransformError:
                continue
            self._errors.append(math.hypot(told.x - truth.x, told.y - truth.y))

    def _take_truth(self, message: Any) -> None:
        pose = pose_of_message(message.pose.pose)
        with self._lock:
            self.truth = pose
            self._waiting.append((message.header.stamp.to_sec(), pose))
            step = math.hypot(pose.x - self._last.x, pose.y - self._last.y) if self._last else 0.0
            if step > 0.02 or self._last is None:
                self._length += step
                self._last = pose

    def _take_collisions(self, message: Int32) -> None:
        self.collisions = message.data


def _wait(done: threading.Event, deadline: float) -> bool:
    while not done.wait(0.5):
        if rospy.get_time() > deadline:
            return False
    return True
