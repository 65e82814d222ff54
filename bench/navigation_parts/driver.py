"""Sends goals, watches the robot against the truth, and puts obstacles in its way."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from dataclasses import dataclass

import numpy as np
from bench.navigation_parts.geodesic import free_cells, length_of, shortest_path
from bench.navigation_parts.worlds import Goal, passage_radius
from bench.node_answers import read_graph
from numpy.typing import NDArray

from ur.robot.base import Base
from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.grid import OCCUPIED, Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.geometry.transform_tree import TransformError
from ur_nodes.ports import actions
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Place
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.values import Odometry, StampedPose

_SAME = Pose2(0.0, 0.0, 0.0)
_ANSWER = 5.0  # s for an answer of a graph or of a service


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
    """A client of navigation that knows the truth. `start` wires it up; callbacks come on the node's thread.

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
        self._waiting: deque[tuple[float, Pose2]] = deque(maxlen=200)
        self._errors: list[float] = []
        self._last: Pose2 | None = None
        self._length = 0.0
        self._sent = 0
        self._state: actions.GoalState | None = None
        self._ended = threading.Event()
        self.truth: Pose2 | None = None
        self.collisions: int | None = None

    def start(self, node: Node) -> Driver:
        """Wire it up."""
        self._node = node
        self._frames = node.transforms
        self._frames.watch(self._compare)
        self._client = node.follow_goals("move_base", self)
        node.subscribe("base_pose_ground_truth", Odometry, self._take_truth, Quality.EVERY)
        node.subscribe("simulator/collisions", int, self._take_collisions, Quality.LATCHED)
        return self

    def on_states(self, states: tuple[actions.GoalState, ...]) -> None:
        """See GoalFollower."""

    def on_goal_end(self, state: actions.GoalState) -> None:
        """See GoalFollower."""
        if state.id == self._goal_id():
            self._state = state
            self._ended.set()

    def ready(self) -> bool:
        """Return whether navigation takes goals and the robot is localised."""
        localised = self._frames.find("map", self._base) is not None
        return localised and self.truth is not None and bool(self._client.servers())

    def read_graph(self) -> Graph:
        """Return the nodes and topics of now. Raises SystemExit: no answer."""
        return read_graph(self._node, _ANSWER)

    def drive(self, goal: Goal, obstacle: str = "", limit: float = 180.0) -> Drive:
        """Send one goal and wait for its end, at most `limit` s of ROS time. `obstacle` comes in the way."""
        assert self.truth is not None
        with self._lock:
            self._errors, self._length, self._last = [], 0.0, self.truth
            start = self.truth
        way = shortest_path(self._grid, self._free, (start.x, start.y), goal[:2])
        if way is None:
            raise SystemExit(f"error: goal {goal}: there is no way to it, expected goals that can be reached")
        target = Pose2(goal[0], goal[1], math.radians(goal[2]))
        began = self._node.now()
        self._send(self._map.inverse().compose(target))
        if obstacle:
            self._place_obstacle(obstacle, way)
        ended = self._wait(began + round(limit * SECOND))
        seconds = (self._node.now() - began) / SECOND
        if not ended:
            self._node.post(self._client.cancel)
            self._ended.wait(5.0)
        time.sleep(0.4)  # let the truth catch up with a robot that has stopped
        with self._lock:
            errors, length, here = tuple(self._errors), self._length, self.truth
        state = self._state
        return Drive(
            reached=ended and state is not None and state.state == "succeeded",
            text=state.text if ended and state is not None else f"not there after {limit:.0f} s",
            shortest=length_of(way),
            length=length,
            seconds=seconds,
            error=math.hypot(here.x - target.x, here.y - target.y),
            turn_error=math.degrees(abs(wrap_angle(here.yaw - target.yaw))),
            errors=errors,
        )

    def _goal_id(self) -> str:
        return f"bench-{self._sent}"

    def _send(self, target: Pose2) -> None:
        self._sent += 1
        self._state = None
        self._ended.clear()
        goal = actions.Goal(self._goal_id(), StampedPose(self._node.now(), "map", target))
        self._node.post(lambda: self._client.send(goal))

    def _wait(self, deadline: int) -> bool:
        while not self._ended.wait(0.5):
            if self._node.now() > deadline:
                return False
        return True

    def _place_obstacle(self, name: str, way: NDArray[np.float64]) -> None:
        place = self._obstacle_place(way)
        request = Place(name, "map", Pose2(*place, 0.0))
        self._node.post(lambda: self._node.call("simulator/place", request, lambda _result: None, _ANSWER))
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

    def _compare(self) -> None:
        """Compare the newest map -> odom with each truth whose odometry has arrived."""
        with self._lock:
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

    def _take_truth(self, odometry: Odometry) -> None:
        pose = odometry.pose
        with self._lock:
            self.truth = pose
            self._waiting.append((seconds_of(odometry.stamp), pose))
            step = math.hypot(pose.x - self._last.x, pose.y - self._last.y) if self._last else 0.0
            if step > 0.02 or self._last is None:
                self._length += step
                self._last = pose

    def _take_collisions(self, count: int) -> None:
        self.collisions = count
