"""A small robot made of mathematics that listens to `cmd_vel`, and a client of move_base beside it, in one process.

One JSON request per line on standard input, one answer per line on standard output. The robot lives in two rooms with
a door (the map); its odometry is right, its localisation too.
"""

from __future__ import annotations

import math
import threading
import time
from typing import Any

import actionlib
import numpy as np
import rospy
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped, TransformStamped, Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.srv import GetPlan
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty
from tests.json_client import answer_requests, claim_output, wait_until
from tests.ur_nodes.navigation.closed_loop import two_rooms
from tf2_msgs.msg import TFMessage

from ur_nodes.codecs.geometry import pose_message, transform_message
from ur_nodes.codecs.maps import fill_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.values import Map

BEAMS = 180


class RobotClient:
    """The robot (20 Hz odometry, 10 Hz scans), and the requests of tests."""

    def __init__(self) -> None:
        self.grid = two_rooms()
        self.occupied = self.grid.values >= 65
        self.pose = Pose2(0.0, 0.0, 0.0)
        self.command, self.commanded = (0.0, 0.0), -math.inf
        self.plans = 0
        self.goals: dict[str, Any] = {}
        self.tf = rospy.Publisher("/tf", TFMessage, queue_size=10)
        self.scan = rospy.Publisher("scan", LaserScan, queue_size=2)
        self.map = rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True)
        message = OccupancyGrid()
        fill_map(message, Map(rospy.Time.now().to_nsec(), "map", self.grid))
        self.map.publish(message)
        self.simple = rospy.Publisher("move_base_simple/goal", PoseStamped, queue_size=1)
        rospy.Subscriber("cmd_vel", Twist, self._on_command)
        rospy.Subscriber("move_base/NavfnROS/plan", Path, self._on_plan)
        rospy.Subscriber("move_base/global_costmap/costmap", OccupancyGrid, self._on_costmap)
        self.costmap_size = 0
        self.action = actionlib.ActionClient("move_base", MoveBaseAction)
        threading.Thread(target=self._live, daemon=True).start()

    def do_ready(self, seconds: float) -> dict[str, Any]:
        wait_until(lambda: self.action.wait_for_server(rospy.Duration(0.2)), seconds, "the action server")
        return {}

    def do_goal(self, name: str, x: float, y: float, yaw: float = 0.0, norm: float = 1.0) -> dict[str, Any]:
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = "map"
        goal.target_pose.pose = pose_message(Pose2(x, y, yaw))
        goal.target_pose.pose.orientation.z *= norm
        goal.target_pose.pose.orientation.w *= norm
        self.goals[name] = self.action.send_goal(goal)
        return {}

    def do_simple_goal(self, x: float, y: float) -> dict[str, Any]:
        message = PoseStamped(pose=pose_message(Pose2(x, y, 0.0)))
        message.header.frame_id = "map"
        wait_until(lambda: self.simple.get_num_connections(), 60.0, "a listener to the simple goal")
        self.simple.publish(message)
        return {}

    def do_end(self, name: str, seconds: float) -> dict[str, Any]:
        """Wait for the end of a goal: its state, text, and where the robot is."""
        handle = self.goals[name]
        wait_until(lambda: handle.get_comm_state() == actionlib.CommState.DONE, seconds, f"the end of goal {name}")
        state = GoalStatus.to_string(handle.get_terminal_state())  # type: ignore[attr-defined]  # added by actionlib
        return {"state": state, "text": handle.get_goal_status_text(), **self._place()}

    def do_moving(self, seconds: float) -> dict[str, Any]:
        wait_until(lambda: self.command[0] > 0.2, seconds, "a robot that moves")
        return self._place()

    def do_pursued(self, name: str, seconds: float) -> dict[str, Any]:
        """Wait until a goal is accepted: one that is cancelled before is recalled, not preempted."""
        handle = self.goals[name]
        wait_until(lambda: handle.get_comm_state() == actionlib.CommState.ACTIVE, seconds, f"goal {name} in hand")
        return {}

    def do_cancel(self, name: str) -> dict[str, Any]:
        self.goals[name].cancel()
        return {}

    def do_make_plan(self, x: float, y: float) -> dict[str, Any]:
        goal = PoseStamped(pose=pose_message(Pose2(x, y, 0.0)))
        goal.header.frame_id = "map"
        answer = rospy.ServiceProxy("move_base/make_plan", GetPlan)(PoseStamped(), goal, 0.0)
        return {"points": [(p.pose.position.x, p.pose.position.y) for p in answer.plan.poses]}

    def do_clear(self) -> dict[str, Any]:
        rospy.ServiceProxy("move_base/clear_costmaps", Empty)()
        return {}

    def do_seen(self, seconds: float) -> dict[str, Any]:
        wait_until(lambda: self.plans and self.costmap_size, seconds, "a plan and a costmap")
        return {"plans": self.plans, "costmap": self.costmap_size}

    def do_topics(self) -> list[tuple[str, str]]:
        """What is published, with types."""
        return [(name, kind) for name, kind in rospy.get_published_topics()]

    def _place(self) -> dict[str, float]:
        return {"x": self.pose.x, "y": self.pose.y, "yaw": self.pose.yaw}

    def _on_command(self, message: Twist) -> None:
        self.command, self.commanded = (message.linear.x, message.angular.z), time.monotonic()

    def _on_plan(self, _message: Path) -> None:
        self.plans += 1

    def _on_costmap(self, message: OccupancyGrid) -> None:
        self.costmap_size = len(message.data)

    def _live(self) -> None:
        rate, tick = rospy.Rate(20), 0
        while not rospy.is_shutdown():
            if time.monotonic() - self.commanded > 0.25:
                self.command = (0.0, 0.0)
            v, w = self.command
            middle = self.pose.yaw + w * 0.025
            self.pose = Pose2(
                self.pose.x + 0.05 * v * math.cos(middle),
                self.pose.y + 0.05 * v * math.sin(middle),
                self.pose.yaw + 0.05 * w,
            )
            now = rospy.Time.now()
            self.tf.publish(
                TFMessage([_link("map", "odom", Pose2(0, 0, 0), now), _link("odom", "base_footprint", self.pose, now)])
            )
            if tick % 2 == 0:
                self.scan.publish(self._look(now))
            tick += 1
            rate.sleep()

    def _look(self, now: rospy.Time) -> LaserScan:
        angles = np.arange(BEAMS) * math.tau / BEAMS - math.pi
        steps = np.arange(0.05, 4.0, 0.025)
        directions = np.stack((np.cos(angles + self.pose.yaw), np.sin(angles + self.pose.yaw)), axis=-1)
        cells = self.grid.cells_of_points((self.pose.x, self.pose.y) + steps[:, None] * directions[:, None])
        inside = self.grid.contains(cells)
        hit = self.occupied[np.where(inside, cells[..., 0], 0), np.where(inside, cells[..., 1], 0)] & inside
        ranges = np.where(hit.any(axis=1), steps[hit.argmax(axis=1)], math.inf)
        scan = LaserScan(angle_min=-math.pi, angle_increment=math.tau / BEAMS, range_min=0.05, range_max=4.0)
        scan.header.frame_id, scan.header.stamp = "base_footprint", now
        scan.ranges = ranges.tolist()
        return scan


def _link(parent: str, child: str, pose: Pose2, now: rospy.Time) -> TransformStamped:
    link = TransformStamped(child_frame_id=child, transform=transform_message(pose))
    link.header.frame_id, link.header.stamp = parent, now
    return link


def main() -> None:
    answers = claim_output()
    rospy.init_node("robot_client", disable_signals=True, log_level=rospy.FATAL)
    answer_requests(answers, RobotClient(), "do_")
    rospy.signal_shutdown("no more requests")


if __name__ == "__main__":
    main()
