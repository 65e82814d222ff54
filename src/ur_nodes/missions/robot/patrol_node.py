"""The node `patrol`: drives a route of places on the robot, by goals of `move_base` and a lease of its own.

It holds the lease of the mux while the patrol is active, so every program shows who drives, and a take-over pauses it.
"""

from __future__ import annotations

import itertools
import sys
import threading
import time
from typing import Any

import rospy
from actionlib_msgs.msg import GoalID, GoalStatusArray
from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult
from std_msgs.msg import Bool, String

from ur.source.diagnostic import UserError
from ur_nodes.geometry.pose import Pose2
from ur_nodes.missions.patrol_text import (
    Answer,
    BadPatrolError,
    PatrolRequest,
    PatrolStatus,
    Route,
    Stop,
    describe_patrol,
    read_request,
    write_status,
)
from ur_nodes.missions.robot.admission import refuse_request
from ur_nodes.missions.robot.patrol import (
    Commands,
    Inputs,
    Patrol,
    answer_request,
    end_patrol,
    pause_patrol,
    resume_patrol,
    start_patrol,
    step_patrol,
)
from ur_nodes.missions.robot.place_lookup_node import find_places
from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS
from ur_nodes.motion.clock import read_steady_time
from ur_nodes.motion.lease.client_node import LeaseClient
from ur_nodes.motion.lease.text import Lease, read_lease
from ur_nodes.motion.lease.view import Identity
from ur_nodes.navigation.goals.goal_claim import (
    REMEMBERED,
    Challenges,
    note_challenge,
    write_any_heading,
    write_goal_id,
)
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.frames import Frames
from ur_nodes.rosio.geometry import pose_message
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.shell import run_node
from ur_nodes.teleop.navigator.goal_tracker import (
    Status,
    Tracker,
    report_at,
    track_result,
    track_sent,
    track_status,
)
from ur_nodes.teleop.navigator.model import GoalState, heading_there

_PERIOD = 0.1  # s
_NANO = 1_000_000_000
_ON_THE_WAY = (0, 1, 6, 7)  # actionlib_msgs/GoalStatus


class PatrolNode:
    """Joins the state machine to its topics, in a thread of its own."""

    def __init__(self) -> None:
        own = Parameters()
        mux = own.text("mux", "cmd_vel_mux")
        navigation = own.text("navigation", "move_base")
        self._map_frame = own.text("global_frame", "map")
        self._base_frame = own.text("robot_base_frame", "base_footprint")
        self._keeper = rospy.resolve_name(own.text("waypoints_of", "keyboard_navigate"))
        self._step_limit = own.number("step_limit", 1800.0, minimum=1.0)
        self._lock = threading.RLock()
        self._patrol = Patrol()
        self._shown: PatrolStatus | None = None
        self._line = ""
        self._lease: Lease | None = None
        self._challenges = Challenges()
        self._stopped = False
        self._tracker = Tracker()
        self._goal = ""
        self._numbers = itertools.count(1)
        self._prefix = f"{rospy.get_name()}-patrol-"
        self._frames = Frames()
        client = "patrol" + rospy.get_name().replace("/", ".")
        self._client = LeaseClient(
            mux, conduct="watch", identity=Identity(client[:64], "patrol", ""), on_challenge=self._take_challenge
        )
        self._status = rospy.Publisher("~status", String, queue_size=1, latch=True)
        self._goals = rospy.Publisher(f"{navigation}/goal", MoveBaseActionGoal, queue_size=1)
        self._cancels = rospy.Publisher(f"{navigation}/cancel", GoalID, queue_size=5)
        self._publish()
        rospy.Subscriber(f"{mux}/lease", String, self._take_lease, queue_size=1)
        rospy.Subscriber(f"{mux}/stopped", Bool, self._take_stopped, queue_size=1)
        rospy.Subscriber(f"{navigation}/status", GoalStatusArray, self._take_statuses, queue_size=1)
        rospy.Subscriber(f"{navigation}/result", MoveBaseActionResult, self._take_result, queue_size=10)
        rospy.Subscriber("~request", String, self._take_request, queue_size=10)
        rospy.on_shutdown(self._shut_down)
        threading.Thread(target=self._run, name="patrol", daemon=True).start()

    @quiet_at_end
    def _run(self) -> None:
        while not rospy.is_shutdown():
            with self._lock:
                self._patrol, commands = step_patrol(self._patrol, self._look(), self._step_limit)
                self._obey(commands)
                if not self._patrol.status.active and self._client.view().mine:
                    self._client.release(final=False)
            time.sleep(_PERIOD)

    def _look(self) -> Inputs:
        view, report = self._client.view(), report_at(self._tracker, time.monotonic())
        mentioned = self._goal and (self._tracker.known or report.state is GoalState.FAILED)
        state = report.state if mentioned else None
        answers = view.state == "unknown" or self._client.link.answer(REQUEST_FRESHNESS / 2.0) is not None
        return Inputs(
            read_steady_time(),
            may_drive=view.state == "unknown" or (view.mine and view.state == "held"),
            ready=answers and self._goals.get_num_connections() > 0,
            other="" if view.mine else view.holder,
            stopped=self._stopped,
            goal=state,
            text=report.text,
        )

    def _obey(self, commands: Commands) -> None:
        if commands.cancel and self._goal:
            self._cancels.publish(GoalID(id=self._goal))
            self._goal = ""
        if commands.send is not None:
            self._send(commands.send)
        self._publish()

    def _send(self, stop: Stop) -> None:
        assert stop.x is not None, "looked up before the start"
        start = f"{self._prefix}{next(self._numbers)}-{time.time():.3f}"
        start = write_any_heading(start) if stop.yaw is None else start
        answer = self._client.link.answer(REQUEST_FRESHNESS / 2.0)
        claimed = answer is not None and self._client.view().state != "unknown"
        self._goal = (
            write_goal_id(start, self._client.client, answer.secs * _NANO + answer.nsecs)
            if claimed and answer is not None
            else start
        )
        yaw = stop.yaw
        if yaw is None:
            here = self._frames.find(self._map_frame, self._base_frame, rospy.Time(0))
            yaw = heading_there(here.planar() if here else None, stop.x, stop.y)
        place = Pose2(stop.x, stop.y, yaw)
        message = MoveBaseActionGoal()
        message.header.stamp = message.goal_id.stamp = message.goal.target_pose.header.stamp = rospy.Time.now()
        message.goal_id.id = self._goal
        message.goal.target_pose.header.frame_id = self._map_frame
        message.goal.target_pose.pose = pose_message(place)
        self._tracker = track_sent(self._tracker, self._goal, place, time.monotonic())
        self._goals.publish(message)

    def _publish(self) -> None:
        status = self._patrol.status
        if status == self._shown:
            return
        self._shown = status
        self._status.publish(write_status(status))
        line = describe_patrol(status)
        if line and line != self._line:
            rospy.loginfo("%s", line)
        self._line = line

    # -- requests --------------------------------------------------------------------------------------------------

    @quiet_at_end
    def _take_request(self, message: Any) -> None:
        latched = (getattr(message, "_connection_header", None) or {}).get("latching") == "1"
        try:
            request = read_request(message.data)
        except BadPatrolError as problem:
            rospy.logwarn("a request for a patrol is ignored, expected %s", problem)
            return
        try:
            route = find_places(request.route, self._keeper)
        except UserError as problem:
            self._answer(request, problem.diagnostics[0].message)
            return
        except BadPatrolError as problem:
            self._answer(request, f"expected {problem}")
            return
        with self._lock:
            self._answer(request, self._admit(request, route, latched=latched))

    def _admit(self, request: PatrolRequest, route: Route, *, latched: bool) -> str:
        """Accept a request, or return why it is refused."""
        now, own = read_steady_time(), self._client.client
        refusal = refuse_request(request, self._lease, own, self._challenges, now, latched=latched)
        if not refusal and request.action in ("start", "resume") and self._stopped:
            refusal = "the emergency stop is on, release it first"
        return refusal or self._accept(request, route, now)

    def _accept(self, request: PatrolRequest, route: Route, now: float) -> str:
        patrol, commands = self._patrol, Commands()
        if request.action == "start":
            patrol, commands = start_patrol(patrol, route, now), Commands(cancel=True)
        elif request.action == "resume":
            if patrol.status.state != "paused":
                return "no patrol is paused"
            patrol = resume_patrol(patrol, now)
        elif request.action == "pause":
            patrol, commands = pause_patrol(patrol, f"by {request.name}" if request.name else "on request", now)
        else:
            patrol, commands = end_patrol(patrol, f"by {request.name}" if request.name else "", now)
        if request.action in ("start", "resume"):
            lease = self._lease
            handed = lease is not None and lease.state == "held" and lease.client == request.client
            (self._client.take if handed else self._client.acquire)()
        self._patrol = patrol
        self._obey(commands)
        return ""

    def _answer(self, request: PatrolRequest, problem: str) -> None:
        if problem:
            rospy.logwarn("%s refused: %s", request.action, problem)
        with self._lock:
            self._patrol = answer_request(self._patrol, Answer(request.id, problem[:300]))
            self._publish()

    # -- topics ----------------------------------------------------------------------------------------------------

    def _take_challenge(self) -> None:
        """Remember a challenge. Without the lock: who holds that may wait for the client, which calls this."""
        client = getattr(self, "_client", None)  # challenges may come before it is there
        value = client.link.newest(REMEMBERED) if client else None
        if value is not None:
            self._challenges = note_challenge(self._challenges, value, read_steady_time())

    def _take_lease(self, message: String) -> None:
        lease = read_lease(message.data)
        if lease is not None:
            with self._lock:
                self._lease = lease

    def _take_stopped(self, message: Bool) -> None:
        with self._lock:
            self._stopped = bool(message.data)

    @quiet_at_end
    def _take_statuses(self, message: Any) -> None:
        statuses = tuple(Status(item.goal_id.id, item.status, item.text) for item in message.status_list)
        with self._lock:
            if self._goal:
                self._tracker = track_status(self._tracker, statuses, time.monotonic())
            for each in statuses:  # of a node of this name that was killed
                if each.goal_id.startswith(self._prefix) and each.goal_id != self._goal and each.status in _ON_THE_WAY:
                    self._cancels.publish(GoalID(id=each.goal_id))

    def _take_result(self, message: Any) -> None:
        status = Status(message.status.goal_id.id, message.status.status, message.status.text)
        with self._lock:
            if self._goal:
                self._tracker = track_result(self._tracker, status, time.monotonic())

    def _shut_down(self) -> None:
        with self._lock:
            if self._goal:
                self._cancels.publish(GoalID(id=self._goal))
        self._client.release()


def main() -> int:
    """Run the node until ROS ends it."""
    nodes: list[PatrolNode] = []
    return run_node("patrol", lambda: nodes.append(PatrolNode()))


if __name__ == "__main__":
    sys.exit(main())
