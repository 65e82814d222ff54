"""A stand-in for Nav2, of rclpy alone: it drives the robot to goals of its action, in a straight line.

It has what page and terminal read of Nav2: the map, its transform, the plan, recoveries, and costmaps. As Nav2 does, it
sends the whole global costmap once, and then changes of it; the local one while its origin moves.
"""

from __future__ import annotations

import math
from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped, TransformStamped, Twist
from map_msgs.msg import OccupancyGridUpdate
from nav2_msgs.action import NavigateToPose
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from tf2_msgs.msg import TFMessage

_BEAT = 0.05  # s
_ARRIVED = 0.1  # m
_FASTEST = 0.3  # m/s
_TURN = 0.8  # rad/s
_CELL = 0.05  # m
_WHOLE, _LOCAL = 200, 60  # cells
_SENSOR = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class DrivingNav2:
    def __init__(self) -> None:
        rclpy.init()
        self.node = node = rclpy.create_node("bt_navigator")
        self._pose: tuple[float, float, float] | None = None
        self._newest: Any = None
        self._beats = 0
        self._waiting: list[rclpy.Future] = []  # goals, for the next beat
        self._velocity = node.create_publisher(Twist, "cmd_vel", 10)
        self._plans = node.create_publisher(Path, "plan", 10)
        self._map = node.create_publisher(OccupancyGrid, "map", _LATCHED)
        self._whole = node.create_publisher(OccupancyGrid, "global_costmap/costmap", _LATCHED)
        self._changes = node.create_publisher(OccupancyGridUpdate, "global_costmap/costmap_updates", 10)
        self._local = node.create_publisher(OccupancyGrid, "local_costmap/costmap", _LATCHED)
        self._transforms = node.create_publisher(TFMessage, "tf_static", _LATCHED)
        node.create_subscription(Odometry, "odom", self._take, _SENSOR)
        node.create_timer(_BEAT, self._beat)
        self._server = ActionServer(
            node,
            NavigateToPose,
            "navigate_to_pose",
            self._drive,
            callback_group=ReentrantCallbackGroup(),
            cancel_callback=lambda _handle: CancelResponse.ACCEPT,
        )
        mount = TransformStamped(child_frame_id="odom")
        mount.header.frame_id = "map"
        mount.transform.rotation.w = 1.0
        self._transforms.publish(TFMessage(transforms=[mount]))
        half = -_WHOLE * _CELL / 2.0
        self._map.publish(_grid("map", _WHOLE, half, half, 0))
        self._whole.publish(_grid("map", _WHOLE, half, half, 20))

    def _take(self, message: Odometry) -> None:
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        self._pose = (place.x, place.y, 2.0 * math.atan2(turn.z, turn.w))

    def _beat(self) -> None:
        self._beats += 1
        waiting, self._waiting = self._waiting, []
        for each in waiting:
            each.set_result(None)
        if self._pose is None or self._beats % 5:
            return
        x, y, _yaw = self._pose
        half = _LOCAL * _CELL / 2.0
        self._local.publish(_grid("odom", _LOCAL, x - half, y - half, 50))
        changed = OccupancyGridUpdate(x=10, y=10, width=2, height=1, data=[100, 100])
        changed.header.frame_id = "map"
        self._changes.publish(changed)

    async def _drive(self, handle: Any) -> Any:
        self._newest = handle
        aim = handle.request.pose.pose.position
        while True:
            beat = rclpy.Future()
            self._waiting.append(beat)
            await beat
            if handle.is_cancel_requested or self._newest is not handle:
                break
            if self._pose is None:
                continue
            x, y, yaw = self._pose
            dx, dy = aim.x - x, aim.y - y
            if math.hypot(dx, dy) < _ARRIVED:
                handle.succeed()
                break
            self._plans.publish(_path((x, y), (aim.x, aim.y)))
            handle.publish_feedback(NavigateToPose.Feedback(number_of_recoveries=1))
            turn = math.remainder(math.atan2(dy, dx) - yaw, math.tau)
            command = Twist()
            command.angular.z = max(-_TURN, min(_TURN, 2.0 * turn))
            command.linear.x = _FASTEST * max(0.0, 1.0 - abs(turn) / 0.4)
            self._velocity.publish(command)
        self._velocity.publish(Twist())
        if handle.is_cancel_requested:
            handle.canceled()
        elif self._newest is not handle:
            handle.abort()
        return NavigateToPose.Result()


def _grid(frame: str, cells: int, x: float, y: float, cost: int) -> OccupancyGrid:
    grid = OccupancyGrid(data=[cost] * cells**2)
    grid.header.frame_id = frame
    grid.info.resolution, grid.info.width, grid.info.height = _CELL, cells, cells
    grid.info.origin.position.x, grid.info.origin.position.y = x, y
    grid.info.origin.orientation.w = 1.0
    return grid


def _path(start: tuple[float, float], end: tuple[float, float]) -> Path:
    path = Path()
    path.header.frame_id = "map"
    for x, y in (start, end):
        pose = PoseStamped(header=path.header)
        pose.pose.position.x, pose.pose.position.y = x, y
        pose.pose.orientation.w = 1.0
        path.poses.append(pose)
    return path


if __name__ == "__main__":
    rclpy.spin(DrivingNav2().node)
