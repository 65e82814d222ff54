"""A small robot made of mathematics that listens to `cmd_vel`, and a client of move_base beside it, in one process.

One JSON request per line on standard input, one answer per line on standard output. The robot lives in two rooms with
a door (the map); its odometry is right, its localisation too.
"""

from __future__ import annotations

import json
import math
import sys
import threading
import time
from typing import Any

import actionlib
import numpy as np
import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from geometry_msgs.msg import PoseStamped, TransformStamped, Twist, TwistStamped
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionGoal, MoveBaseGoal
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.srv import GetPlan
from sensor_msgs.msg import LaserScan, Range
from std_msgs.msg import String, Time
from std_srvs.srv import Empty
from tests.json_client import answer_requests, claim_output, wait_until
from tests.ur_nodes.navigation.closed_loop import two_rooms
from tf2_msgs.msg import TFMessage

from ur_nodes.geometry.pose import Pose2
from ur_nodes.rosio.geometry import pose_message, transform_message
from ur_nodes.rosio.grid_message import grid_message

BEAMS = 180
CONE, HEARD, THICK = 0.5, 3.0, 0.12  # a sonar: rad, m; the radius of a pillar, m


class RobotClient:
    """The robot (20 Hz odometry, 10 Hz scans), with `mux` one that issues challenges, and the requests of tests."""

    def __init__(self, *, mux: bool) -> None:
        self.grid = two_rooms()
        self.occupied = self.grid.values >= 65
        self.pose = Pose2(0.0, 0.0, 0.0)
        self.command, self.commanded = (0.0, 0.0), -math.inf
        self.commands = 0
        self.seeing = True
        self.plans = 0
        self.goals: dict[str, Any] = {}
        self.tf = rospy.Publisher("/tf", TFMessage, queue_size=10)
        self.scan = rospy.Publisher("scan", LaserScan, queue_size=2)
        self.sonar = rospy.Publisher("sonars", Range, queue_size=2)
        self.pillar: tuple[float, float] | None = None
        self.nearest = math.inf
        self.map = rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True)
        self.map.publish(grid_message(self.grid, "map", rospy.Time.now()))
        self.simple = rospy.Publisher("move_base_simple/goal", PoseStamped, queue_size=1)
        self.mux = FakeMux() if mux else None
        if mux:
            rospy.Subscriber("cmd_vel_stamped", TwistStamped, self._take_stamped)
        else:
            rospy.Subscriber("cmd_vel", Twist, self._take_command)
        self.statuses: list[Any] = []
        self.direct = rospy.Publisher("move_base/goal", MoveBaseActionGoal, queue_size=5)
        self.cancels = rospy.Publisher("move_base/cancel", GoalID, queue_size=5)
        self.continues = rospy.Publisher("move_base/continue", GoalID, queue_size=5)
        rospy.Subscriber("move_base/status", GoalStatusArray, self._take_statuses)
        rospy.Subscriber("move_base/NavfnROS/plan", Path, self._take_plan)
        rospy.Subscriber("move_base/global_costmap/costmap", OccupancyGrid, self._take_costmap)
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

    def do_claim(
        self, client: str, x: float, y: float, age: float = 0.0, number: int = 0, start: str = "test", yaw: float = 0.0
    ) -> dict[str, Any]:
        """Send a goal as our clients do: its id says who sends it and answers a challenge, `age` seconds old."""
        mux = self.mux
        assert mux
        wait_until(lambda: self.direct.get_num_connections() > 0, 60.0, "a listener to goals")
        topics = (mux.challenges, mux.lease)
        wait_until(lambda: all(topic.get_num_connections() for topic in topics), 60.0, "a subscriber of the mux")
        first = mux.issued[-1]
        wait_until(lambda: mux.issued[-1] - first > 0.1, 60.0, "a challenge")
        answered = mux.stamp
        wait_until(lambda: mux.issued[-1] - answered.to_sec() > 0.1, 60.0, "challenges after the one that is answered")
        stamp = rospy.Time.from_sec(mux.issued[-1] - age) if age else answered
        goal = MoveBaseActionGoal()
        goal.goal_id.id = f"{number}-{start}@{client}@{stamp.secs}.{stamp.nsecs:09d}"
        goal.goal.target_pose.header.frame_id = "map"
        goal.goal.target_pose.pose = pose_message(Pose2(x, y, yaw))
        self.direct.publish(goal)
        return {"id": goal.goal_id.id}

    def do_lease(self, **lease: Any) -> dict[str, Any]:
        """Publish a lease as the mux's from now on."""
        assert self.mux
        self.mux.lease.publish(json.dumps(lease))
        return {}

    def do_mute(self, mute: bool) -> dict[str, Any]:
        """The mux issues no challenges, or goes on."""
        assert self.mux
        self.mux.mute = mute
        return {}

    def do_status(self, id: str, text: str, state: str, seconds: float) -> dict[str, Any]:
        """Wait until the status list has this goal in this state with a text that begins like this."""
        number = getattr(GoalStatus, state)

        def is_so() -> bool:
            return any(s.goal_id.id == id and s.status == number and s.text.startswith(text) for s in self.statuses)

        try:
            wait_until(is_so, seconds, "")
        except TimeoutError:
            said = [(s.goal_id.id, GoalStatus.to_string(s.status), s.text) for s in self.statuses]
            raise TimeoutError(f"waited for {id} {state} {text!r}, the list is {said}") from None
        return self._place()

    def do_cancel_id(self, id: str) -> dict[str, Any]:
        wait_until(self.cancels.get_num_connections, 60.0, "a subscriber of cancel")
        self.cancels.publish(GoalID(id=id))
        return {}

    def do_continue(self, id: str = "", late: bool = False) -> dict[str, Any]:
        wait_until(lambda: self.continues.get_num_connections() > 0, 60.0, "a listener to continue")
        self.continues.publish(GoalID(id=id, stamp=rospy.Time(1, 1) if late else rospy.Time()))
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
        state = GoalStatus.to_string(handle.get_terminal_state())
        return {"state": state, "text": handle.get_goal_status_text(), **self._place()}

    def do_moving(self, seconds: float) -> dict[str, Any]:
        wait_until(lambda: self.command[0] > 0.2, seconds, "a robot that moves")
        return self._place()

    def do_stopped(self, seconds: float) -> dict[str, Any]:
        wait_until(lambda: self.command == (0.0, 0.0), seconds, "a robot that stands")
        return self._place()

    def do_cancel(self, name: str) -> dict[str, Any]:
        self.goals[name].cancel()
        return {}

    def do_blind(self, blind: bool) -> dict[str, Any]:
        self.seeing = not blind
        return {}

    def do_pillar(self, x: float, y: float) -> dict[str, Any]:
        """Something stands there that only a sonar hears: one that looks ahead."""
        self.pillar = (x, y)
        return {}

    def do_nearest(self) -> dict[str, Any]:
        """How near the middle of the robot came to the side of the pillar, m."""
        return {"nearest": self.nearest}

    def do_commands(self) -> dict[str, Any]:
        """How many commands have come within the next ten periods of the controller."""
        before, end = self.commands, time.monotonic() + 1.0
        wait_until(lambda: time.monotonic() > end, 5.0, "time")
        return {"commands": self.commands - before}

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

    def _place(self) -> dict[str, float]:
        return {"x": self.pose.x, "y": self.pose.y, "yaw": self.pose.yaw}

    def _take_command(self, message: Twist) -> None:
        self.command, self.commanded = (message.linear.x, message.angular.z), time.monotonic()
        self.commands += 1

    def _take_stamped(self, message: TwistStamped) -> None:
        assert self.mux
        if not message.header.frame_id and any(
            abs(message.header.stamp.to_sec() - each) < 1e-6 and self.mux.issued[-1] - each < 0.15
            for each in self.mux.issued
        ):
            self._take_command(message.twist)

    def _take_statuses(self, message: GoalStatusArray) -> None:
        self.statuses = message.status_list

    def _take_plan(self, _message: Path) -> None:
        self.plans += 1

    def _take_costmap(self, message: OccupancyGrid) -> None:
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
            if self.pillar and tick % 2 == 0:
                self.sonar.publish(self._listen(*self.pillar, now))
            if self.seeing and tick % 2 == 0:
                self.scan.publish(self._look(now))
            tick += 1
            rate.sleep()

    def _listen(self, x: float, y: float, now: rospy.Time) -> Range:
        dx, dy = x - self.pose.x, y - self.pose.y
        away = math.hypot(dx, dy)
        self.nearest = min(self.nearest, away - THICK)
        off = abs(math.remainder(math.atan2(dy, dx) - self.pose.yaw, math.tau)) - math.atan2(THICK, away)
        heard = Range(field_of_view=CONE, min_range=0.02, max_range=HEARD)
        heard.header.frame_id, heard.header.stamp = "base_footprint", now
        heard.range = away - THICK if off < CONE / 2 and away - THICK < HEARD else math.inf
        return heard

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


class FakeMux:
    """Issues challenges at 30 Hz and publishes the lease that the test wants."""

    def __init__(self) -> None:
        self.mute = False
        self.stamp = rospy.Time()
        self.issued = [0.0]
        self.challenges = rospy.Publisher("cmd_vel_mux/challenge", Time, queue_size=1, tcp_nodelay=True)
        self.lease = rospy.Publisher("cmd_vel_mux/lease", String, queue_size=1, latch=True)
        rospy.Timer(rospy.Duration(1 / 30), self._issue)

    def _issue(self, _event: Any) -> None:
        if not self.mute:
            self.stamp = rospy.Time.from_sec(1000.0 + time.monotonic())
            self.issued = [*self.issued[-60:], self.stamp.to_sec()]
            self.challenges.publish(Time(self.stamp))


def _link(parent: str, child: str, pose: Pose2, now: rospy.Time) -> TransformStamped:
    link = TransformStamped(child_frame_id=child, transform=transform_message(pose))
    link.header.frame_id, link.header.stamp = parent, now
    return link


def main() -> None:
    answers = claim_output()
    rospy.init_node("robot_client", disable_signals=True, log_level=rospy.FATAL)
    answer_requests(answers, RobotClient(mux="mux" in sys.argv), "do_")
    rospy.signal_shutdown("no more requests")


if __name__ == "__main__":
    main()
