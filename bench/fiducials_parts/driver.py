"""Drives a simulated robot by its true pose, and keeps the pose that it believes beside that."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable

from bench.node_answers import await_answer, read_graph

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.transform_tree import TransformError
from ur_nodes.ports.fiducials import SeenFiducials
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.values import Odometry, Result, Twist

_ANSWER = 10.0  # s
_BASE = "base_footprint"


class Driver:
    """Drives along corners by the true pose. `start` wires it up; callbacks come on the node's thread."""

    def __init__(self) -> None:
        self._waiting: deque[tuple[float, Pose2]] = deque(maxlen=200)
        self.reset()

    def start(self, node: Node) -> Driver:
        """Wire it up."""
        self._node = node
        self._frames = node.transforms
        self._frames.watch(self._compare)
        self._velocity = node.publish("key_vel", Twist)
        node.subscribe("base_pose_ground_truth", Odometry, self._take, Quality.EVERY)
        node.subscribe("simulator/collisions", int, self._take_collisions, Quality.LATCHED)
        node.subscribe("odom", Odometry, self._take_odometry)
        node.subscribe("fiducial_vertices", SeenFiducials, self._count, Quality.EVERY)
        return self

    def reset(self) -> None:
        """Forget all of the run before."""
        self._since = time.time()
        self.true: Pose2 | None = None
        self.odometry = Pose2(0.0, 0.0, 0.0)
        self.pictures = 0
        self.offs: list[tuple[float, float]] = []
        self.collisions: int | None = None

    def follow(self, corners: list[tuple[float, float]], speed: float) -> None:
        """Drive from corner to corner: turn towards the next one, then go."""
        for x, y in corners:
            deadline = time.monotonic() + 90.0
            while time.monotonic() < deadline:
                if self.true is not None:
                    dx, dy = x - self.true.x, y - self.true.y
                    if math.hypot(dx, dy) < 0.15:
                        break
                    turn = math.remainder(math.atan2(dy, dx) - self.true.yaw, math.tau)
                    self._send(Twist(speed * max(0.0, 1.0 - abs(turn) / 0.4), max(-0.8, min(0.8, 2.0 * turn))))
                time.sleep(0.05)
            else:
                raise SystemExit(f"error: the robot did not reach {x}, {y} within 90 s: it is at {self.true}")
        time.sleep(0.5)

    def save_map(self) -> str:
        """Ask for the map of fiducials to be saved; return the answer. Raises SystemExit: there is none."""

        def ask(take: Callable[[Result], None]) -> None:
            self._node.call("save_map", Trigger(), take, _ANSWER)

        result = await_answer(self._node, ask, 2.0 * _ANSWER)
        if result is None:
            raise SystemExit(f"error: save_map did not answer within {_ANSWER:g} s")
        return result.text

    def lidars(self) -> list[str]:
        """Return the topics of scans that are published now. Raises SystemExit: the graph cannot be read."""
        published = read_graph(self._node, _ANSWER).published()
        return [name for name, kind in published if kind.endswith("/LaserScan")]

    def _send(self, twist: Twist) -> None:
        self._node.post(lambda: self._velocity.send(twist))

    def _count(self, _seen: SeenFiducials) -> None:
        self.pictures += 1

    def _take_odometry(self, odometry: Odometry) -> None:
        self.odometry = odometry.pose

    def _take_collisions(self, count: int) -> None:
        self.collisions = count

    def _take(self, odometry: Odometry) -> None:
        self.true = odometry.pose
        self._waiting.append((seconds_of(odometry.stamp), odometry.pose))

    def _compare(self) -> None:
        """Compare each truth whose odometry has arrived with the pose that the robot believes at that time."""
        while self._waiting:
            stamp, truth = self._waiting[0]
            newest = self._frames.newest(_BASE)
            if newest is None or newest < stamp:
                return
            self._waiting.popleft()
            if (self._frames.newest("odom") or 0.0) < self._since:  # of the run before
                continue
            try:
                found = self._frames.pose("map", "odom").compose(self._frames.pose("odom", _BASE, stamp))
            except TransformError:  # not known yet
                continue
            off = math.hypot(found.x - truth.x, found.y - truth.y)
            self.offs.append((off, abs(math.remainder(found.yaw - truth.yaw, math.tau))))
