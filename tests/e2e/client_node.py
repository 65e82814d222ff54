"""A ROS client that tests talk to: one JSON request per line on standard input, one answer per line on standard output.

rospy can be started only once in a process, so each test session's client is a process of its own.
"""

from __future__ import annotations

import contextlib
import json
import math
from typing import Any

import actionlib
import rospy
import tf2_ros
from actionlib_msgs.msg import GoalStatus, GoalStatusArray
from geometry_msgs.msg import PoseWithCovarianceStamped, Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry
from nav_msgs.srv import SetMap, SetMapRequest
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Int32, String
from std_srvs.srv import Empty, Trigger
from tests.json_client import answer_requests, claim_output, wait_until

from ur_nodes.client.patrol_text import PatrolStatus, read_status
from ur_nodes.codecs.geometry import pose3_of_transform, pose_message, pose_of_message
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.motion.obstacle_stop.report import read_report
from ur_nodes.ros1.node import RosNode

_STATES = {value: name for name, value in vars(GoalStatus).items() if name.isupper()}


class DrivingClient:
    """What a person with RViz and a few terminals could do."""

    def __init__(self) -> None:
        self.truth: Odometry | None = None
        self.odom: Odometry | None = None
        self.localised: Pose2 | None = None
        self.placed: list[Pose2] = []
        self.scans = 0
        self.active: list[str] = []
        self.collisions = 0
        self.obstacle_stop = ""
        self.stopped: bool | None = None
        self.goals: list[GoalStatus] = []
        self.buffer = tf2_ros.Buffer()
        self.listener = tf2_ros.TransformListener(self.buffer)
        self.key_vel = rospy.Publisher("key_vel", Twist, queue_size=1)
        self.initial_pose = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=1)
        self.node = RosNode()
        self.lease = LeaseClient(self.node, "cmd_vel_mux", "test", conduct="watch")
        self.node.begin()
        self.action = actionlib.SimpleActionClient("move_base", MoveBaseAction)
        rospy.Subscriber("base_pose_ground_truth", Odometry, self._set_truth)
        rospy.Subscriber("amcl_pose", PoseWithCovarianceStamped, self._set_localised)
        rospy.Subscriber("initialpose", PoseWithCovarianceStamped, self._add_placed)
        rospy.Subscriber("odom", Odometry, self._set_odom)
        rospy.Subscriber("scan", LaserScan, self._count_scan)
        rospy.Subscriber("move_base/status", GoalStatusArray, self._set_goals)
        rospy.Subscriber("simulator/collisions", Int32, self._set_collisions)
        rospy.Subscriber("cmd_vel_mux/obstacle_stop", String, self._set_obstacle_stop)
        rospy.Subscriber("cmd_vel_mux/active", String, self._add_active)
        rospy.Subscriber("cmd_vel_mux/stopped", Bool, self._set_stopped)
        self.patrols: list[PatrolStatus] = []
        self.patrol_requests = rospy.Publisher("patrol/request", String, queue_size=5)
        rospy.Subscriber("patrol/status", String, self._add_patrol, queue_size=50)

    def do_ready(self, seconds: float) -> dict[str, Any]:
        """Wait until the robot is localised and takes goals."""
        wait_until(lambda: self.truth and self.odom and self.scans, seconds, "odom, scan and base_pose_ground_truth")
        wait_until(lambda: self.active and self.key_vel.get_num_connections(), seconds, "the mux")
        wait_until(lambda: self.action.wait_for_server(rospy.Duration(0.1)), seconds, "the action server move_base")
        wait_until(lambda: self.buffer.can_transform("map", "base_footprint", rospy.Time()), seconds, "map to base tf")
        return {}

    def do_goal(self, x: float, y: float, degrees: float = 0.0, seconds: float = 0.0) -> dict[str, Any]:
        """Send a goal; with `seconds`, wait that long for its end."""
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = "map"
        goal.target_pose.header.stamp = rospy.Time.now()
        goal.target_pose.pose = pose_message(Pose2(x, y, math.radians(degrees)))
        self.action.send_goal(goal)
        return self.do_result(seconds) if seconds else {}

    def do_result(self, seconds: float) -> dict[str, Any]:
        """Wait for the end of the goal."""

        # SimpleActionClient misses a goal's end that arrives before its send_goal returns; the goal's handle does not.
        def has_ended() -> bool:
            return bool(self.action.gh is not None and self.action.gh.get_comm_state() == actionlib.CommState.DONE)

        with contextlib.suppress(TimeoutError):
            wait_until(has_ended, seconds, "")
        state = _STATES[self.action.get_state()] if has_ended() else "RUNNING"
        return {"state": state, "text": self.action.get_goal_status_text(), **self.do_where()}

    def do_goals(self, state: str, text: str, seconds: float) -> dict[str, Any]:
        """Wait until the newest goal of all is in this state and its text begins like this."""

        def is_so() -> bool:
            newest = self.goals[-1:]
            return bool(newest) and _STATES[newest[0].status] == state and newest[0].text.startswith(text)

        try:
            wait_until(is_so, seconds, "")
        except TimeoutError:
            said = [(_STATES[each.status], each.text) for each in self.goals[-3:]]
            raise TimeoutError(f"no goal {state} {text!r} within {seconds:g} s, the last are {said}") from None
        return self.do_where()

    def do_ask_patrol(self, seconds: float, action: str, **request: Any) -> dict[str, Any]:
        """Ask for a patrol as a script does, and return why it was refused."""
        wait_until(self.patrol_requests.get_num_connections, seconds, "a node that drives patrols")
        name = f"script-{len(self.patrols)}"
        self.patrol_requests.publish(json.dumps({"id": name, "do": action, **request}))
        wait_until(lambda: any(each.answer and each.answer.id == name for each in self.patrols), seconds, "an answer")
        return {"problem": next(e.answer.problem for e in self.patrols if e.answer and e.answer.id == name)}

    def do_patrol(self, state: str, seconds: float, rounds: int = 0) -> dict[str, Any]:
        """Wait until the patrol is in this state and has driven so many rounds."""

        def is_so() -> bool:
            return bool(self.patrols) and self.patrols[-1].state == state and self.patrols[-1].rounds >= rounds

        try:
            wait_until(is_so, seconds, "")
        except TimeoutError:
            raise TimeoutError(f"no patrol {state} within {seconds:g} s, the last are {self.patrols[-3:]}") from None
        return {"reason": self.patrols[-1].reason, "index": self.patrols[-1].index}

    def do_free(self, seconds: float) -> dict[str, Any]:
        """Take the lease, as a person would after a program that was killed, and let others have it."""
        wait_until(lambda: self.lease.view().state != "unknown", seconds, "the lease of the mux")
        if self.lease.view().state != "free":
            self.node.ask(self.lease.take_over)
            wait_until(lambda: self.lease.view().mine, seconds, "the lease")
            self.node.ask(lambda: self.lease.release(final=False))
            wait_until(lambda: not self.lease.view().mine, seconds, "the release of the lease")
        return {}

    def do_lease(self, state: str, seconds: float) -> dict[str, Any]:
        """Wait for a state of the lease."""
        wait_until(lambda: self.lease.view().state == state, seconds, f"the lease to be {state}")
        return {}

    def do_cancel(self) -> dict[str, Any]:
        """Cancel the goal."""
        self.action.cancel_goal()
        return {}

    def do_where(self) -> dict[str, Any]:
        """The true pose, the believed one, the speed and whether the goal runs."""
        assert self.truth
        true = pose_of_message(self.truth.pose.pose)
        believed = pose3_of_transform(
            self.buffer.lookup_transform("map", "base_footprint", rospy.Time(), rospy.Duration(30.0)).transform
        ).planar()
        twist = self.truth.twist.twist
        speed = math.hypot(twist.linear.x, twist.angular.z)
        return {"true": true, "believed": believed, "speed": speed, "collisions": self.collisions}

    def do_drive(self, forward: float, turn: float, seconds: float) -> dict[str, Any]:
        """Drive as a keyboard does, at 20 Hz for a while, then nothing."""
        command = Twist()
        command.linear.x, command.angular.z = forward, turn
        rate = rospy.Rate(20)
        for _ in range(round(seconds * 20)):
            self.key_vel.publish(command)
            rate.sleep()
        return self.do_where()

    def do_still(self, seconds: float) -> dict[str, Any]:
        """Wait until the robot stands."""
        wait_until(lambda: self.do_where()["speed"] < 0.01, seconds, "the robot to stand still")
        return self.do_where()

    def do_moving(self, seconds: float) -> dict[str, Any]:
        """Wait until the robot moves."""
        wait_until(lambda: self.do_where()["speed"] > 0.1, seconds, "the robot to move")
        return self.do_where()

    def do_active(self, name: str, seconds: float) -> dict[str, Any]:
        """Wait until the mux follows a source, or `idle`; who it followed since the last time."""
        wait_until(lambda: self.active and self.active[-1] == name, seconds, f"the mux to follow {name}")
        told = self.active[:]
        del self.active[: len(told) - 1]
        return {"active": [each for n, each in enumerate(told) if n == 0 or told[n - 1] != each]}

    def do_touched(self, count: int, seconds: float) -> dict[str, Any]:
        """Wait until the robot has touched something so often."""
        wait_until(lambda: self.collisions >= count, seconds, f"{count} collisions")
        return {}

    def do_obstacle_stop(self, state: str, seconds: float) -> dict[str, Any]:
        """Wait until the mux reports this state of its obstacle stop."""
        wait_until(lambda: self.obstacle_stop == state, seconds, f"the obstacle stop to be {state}")
        return {}

    def do_stopped(self, value: bool, seconds: float) -> dict[str, Any]:
        """Wait until the mux says so of an emergency."""
        wait_until(lambda: self.stopped is value, seconds, f"the mux to say that stopped is {value}")
        return {}

    def do_call(self, service: str) -> dict[str, Any]:
        """Call a service of the kind Trigger."""
        rospy.wait_for_service(service, 30)
        return {"message": rospy.ServiceProxy(service, Trigger)().message}

    def do_place(self, x: float, y: float, degrees: float) -> dict[str, Any]:
        """Put the robot somewhere else, telling nobody."""
        request = SetMapRequest()
        request.initial_pose.pose.pose = pose_message(Pose2(x, y, math.radians(degrees)))
        rospy.wait_for_service("simulator/place", 10)
        return {"success": rospy.ServiceProxy("simulator/place", SetMap)(request).success}

    def do_believe(self, x: float, y: float, degrees: float, seconds: float) -> dict[str, Any]:
        """Tell the localiser where the robot is, as RViz's button does, and wait until it believes it."""
        message = PoseWithCovarianceStamped()
        message.header.frame_id = "map"
        message.pose.pose = pose_message(Pose2(x, y, math.radians(degrees)))
        message.pose.covariance[0] = message.pose.covariance[7] = 0.01
        message.pose.covariance[35] = 0.01

        self.localised = None

        def near() -> bool:
            self.initial_pose.publish(message)
            return self.localised is not None and math.hypot(self.localised.x - x, self.localised.y - y) < 0.15

        wait_until(near, seconds, "amcl to believe the initial pose", pause=0.3)
        return self.do_where()

    def do_placed(self, seconds: float) -> dict[str, Any]:
        """Wait for the next initial pose that anybody has published."""
        wait_until(lambda: self.placed, seconds, "an initial pose")
        return {"pose": self.placed.pop(0)}

    def do_globalise(self) -> dict[str, Any]:
        """Tell the localiser that it could be anywhere."""
        rospy.wait_for_service("global_localization", 10)
        rospy.ServiceProxy("global_localization", Empty)()
        return {}

    def _set_goals(self, message: GoalStatusArray) -> None:
        self.goals = message.status_list

    def _add_active(self, message: String) -> None:
        self.active.append(message.data)

    def _add_patrol(self, message: String) -> None:
        status = read_status(message.data)
        assert status is not None
        self.patrols.append(status)

    def _set_stopped(self, message: Bool) -> None:
        self.stopped = bool(message.data)

    def _set_truth(self, message: Odometry) -> None:
        self.truth = message

    def _set_localised(self, message: PoseWithCovarianceStamped) -> None:
        self.localised = pose_of_message(message.pose.pose)

    def _add_placed(self, message: PoseWithCovarianceStamped) -> None:
        self.placed.append(pose_of_message(message.pose.pose))

    def _set_obstacle_stop(self, message: String) -> None:
        report = read_report(message.data)
        self.obstacle_stop = report.state if report else ""

    def _set_collisions(self, message: Int32) -> None:
        self.collisions = message.data

    def _set_odom(self, message: Odometry) -> None:
        self.odom = message

    def _count_scan(self, _message: LaserScan) -> None:
        self.scans += 1


def main() -> None:
    """Answer requests until standard input ends."""
    answers = claim_output()
    rospy.init_node("test_client", anonymous=True, disable_signals=True)
    answer_requests(answers, DrivingClient(), "do_")
    rospy.signal_shutdown("done")


if __name__ == "__main__":
    main()
