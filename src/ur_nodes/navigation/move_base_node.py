"""The node `move_base`: drives to goals. Stands in for the program of that name in the package `move_base`."""

from __future__ import annotations

import itertools
import math
import sys
import threading
from typing import Any

import rospy
from actionlib import ActionServer
from geometry_msgs.msg import PoseStamped, Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionGoal, MoveBaseFeedback, MoveBaseResult
from nav_msgs.srv import GetPlan, GetPlanRequest, GetPlanResponse
from std_msgs.msg import Bool
from std_srvs.srv import Empty, EmptyRequest, EmptyResponse

from ur_nodes.navigation.frame_history import FrameError
from ur_nodes.navigation.global_plan import path_is_free
from ur_nodes.navigation.local_plan import FollowSettings
from ur_nodes.navigation.move_base_parameters_node import read_settings
from ur_nodes.navigation.move_base_view_node import MoveBaseView, path_message
from ur_nodes.navigation.navigator import Ending, Inputs, Navigator, Outputs, Phase, PlanAnswer
from ur_nodes.navigation.plan_worker_node import PlanRequest, PlanWorker, answer_request
from ur_nodes.navigation.recovery import Behaviour
from ur_nodes.navigation.world_view_node import WorldView
from ur_nodes.rosio.geometry import Pose2, pose_message, pose_of_message
from ur_nodes.rosio.shell import run_node


class MoveBase:
    """Takes goals as upstream does and steps the navigator at the controller frequency, in a thread of its own."""

    def __init__(self) -> None:
        self._settings = read_settings()
        self._view = MoveBaseView(self._settings.world.frame, self._settings.local.frame)
        self._world = WorldView(self._settings)
        self._navigator = Navigator(
            self._settings.navigator, self._settings.limits, FollowSettings(), self._settings.footprint
        )
        self._server = ActionServer("move_base", MoveBaseAction, self._take_goal, self._take_cancel, auto_start=False)
        # The server calls back with its lock held, and takes it when a goal ends: a second lock would be a deadlock.
        self._lock = self._server.lock
        self._handle: Any = None
        self._goal: Pose2 | None = None
        self._key = 0
        self._answer: PlanAnswer | None = None
        self._sent = (0.0, 0.0)
        self._stopped = False
        self._clear: Behaviour | None = None
        self._path_blocked = False
        self._tick = 0
        self._shown = (0, 0)
        self._worker = PlanWorker(self._settings.planner, self._take_answer)
        self._cmd_vel = rospy.Publisher("cmd_vel", Twist, queue_size=1, tcp_nodelay=True)
        self._action_goal = rospy.Publisher("move_base/goal", MoveBaseActionGoal, queue_size=1)
        rospy.Subscriber("move_base_simple/goal", PoseStamped, self._take_simple_goal, queue_size=1)
        rospy.Subscriber(f"{self._settings.mux}/stopped", Bool, self._take_stopped, queue_size=1)
        rospy.Service("~make_plan", GetPlan, self._make_plan)
        rospy.Service("~clear_costmaps", Empty, self._clear_costmaps)
        rospy.on_shutdown(self._shut_down)
        self._server.start()
        threading.Thread(target=self._run, name="control", daemon=True).start()

    def _run(self) -> None:
        repeats = self._settings.repeats
        rate = rospy.Rate(repeats / self._settings.navigator.period, reset=True)
        last = 0.0
        for beat in itertools.cycle(range(repeats)):
            if rospy.is_shutdown():
                return
            if beat == 0:
                now = rospy.get_time()
                if now < last - 1.0:
                    self._world.forget()
                last = now
                with self._lock:
                    self._control(now)
                self._show()
                self._tick += 1
            else:
                self._repeat()
            try:
                rate.sleep()
            except rospy.ROSInterruptException:
                return

    def _repeat(self) -> None:
        """Say the last command again: whoever drives takes one that is old for the end of the commander."""
        with self._lock:
            if self._navigator.phase is not Phase.IDLE and self._sent != (0.0, 0.0):
                self._send(*self._sent)

    def _control(self, now: float) -> None:
        idle = self._navigator.phase is Phase.IDLE
        if not idle or self._tick % 5 == 0:
            self._world.update()
        if self._clear is not None:
            self._forget_obstacles(self._clear)
        if idle:
            return
        odom = self._world.odom()
        trouble = self._world.trouble(now)
        if self._tick % 3 == 0:
            self._path_blocked = self._is_path_blocked()
        answer, self._answer = self._answer, None
        out = self._navigator.step(
            Inputs(
                now=now,
                motion=self._world.motion(self._sent, now),
                odom=odom or Pose2(0.0, 0.0, 0.0),
                local=self._world.local.occupied(),
                answer=answer,
                trouble=trouble,
                path_blocked=self._path_blocked,
            )
        )
        self._obey(out)
        if answer is not None and answer.path is not None:
            self._path_blocked = False
            self._view.show_plan(answer.path)
        if self._tick % 2 == 0:
            self._view.show_drive(self._navigator.path, out.ahead)
            self._give_feedback()

    def _obey(self, out: Outputs) -> None:
        if out.say:
            rospy.logwarn("%s", out.say)
        if out.clear is not None:
            self._forget_obstacles(out.clear)
        if out.command is not None:
            self._send(*out.command)
        if out.plan:
            self._ask_for_plan()
        if out.ending is not None:
            self._finish(out.ending, out.text)

    def _send(self, speed: float, turn: float) -> None:
        self._sent = (speed, turn)
        message = Twist()
        message.linear.x, message.angular.z = speed, turn
        self._cmd_vel.publish(message)

    def _finish(self, ending: Ending, text: str) -> None:
        handle, self._handle, self._goal = self._handle, None, None
        if ending is Ending.REACHED:
            rospy.loginfo("%s", text)
            handle.set_succeeded(MoveBaseResult(), text)
        else:
            rospy.logerr("gave up: %s", text)
            handle.set_aborted(MoveBaseResult(), text)

    def _ask_for_plan(self) -> None:
        pose, costs = self._world.robot_in_map(), self._world.costmaps()
        if pose is None or costs is None or self._goal is None:
            return
        self._key += 1
        goal = (self._goal.x, self._goal.y)
        self._worker.ask(PlanRequest(self._key, (pose.x, pose.y), goal, *costs))

    def _take_answer(self, key: int, answer: PlanAnswer) -> None:
        with self._lock:
            if key == self._key:
                self._answer = answer

    def _take_goal(self, handle: Any) -> None:
        target = handle.get_goal().target_pose
        goal = self._goal_in_map(target)
        with self._lock:
            old, self._handle = self._handle, None
            if old is not None:
                old.set_canceled(MoveBaseResult(), "a new goal has replaced this one")
            if self._stopped:
                goal = "emergency stop is on; release it first"
            if isinstance(goal, str):
                rospy.logerr("goal refused: %s", goal)
                handle.set_accepted()
                handle.set_aborted(MoveBaseResult(), goal)
                self._halt()
                return
            handle.set_accepted()
            self._handle, self._goal, self._answer = handle, goal, None
            self._key += 1
            self._path_blocked = False
            self._navigator.start(goal, rospy.get_time())
            self._view.show_goal(goal)

    def _goal_in_map(self, target: PoseStamped) -> Pose2 | str:
        """The goal's pose in the map, or why it cannot be used."""
        position, turn = target.pose.position, target.pose.orientation
        numbers = (position.x, position.y, turn.x, turn.y, turn.z, turn.w)
        if not all(math.isfinite(number) for number in numbers):
            return "a number of the goal is not finite, expected a pose"
        if abs(math.hypot(*numbers[2:]) - 1.0) > 0.1:
            return "the goal's orientation is not a unit quaternion, expected one (for no rotation: w = 1)"
        frame = target.header.frame_id.lstrip("/")
        goal: Pose2 = pose_of_message(target.pose)
        if not frame:
            return f"the goal has no frame_id, expected {self._settings.world.frame}"
        if frame == self._settings.world.frame:
            return goal
        stamp = target.header.stamp.to_sec() or None
        try:
            return self._world.frames.pose(self._settings.world.frame, frame, stamp).compose(goal)
        except FrameError as problem:
            return f"the goal is in the frame {frame}: {problem}"

    def _take_cancel(self, handle: Any) -> None:
        with self._lock:
            if self._handle is None or handle.get_goal_id().id != self._handle.get_goal_id().id:
                return
            self._handle = None
            self._halt()
            handle.set_canceled(MoveBaseResult(), "cancelled")

    def _take_stopped(self, message: Bool) -> None:
        """Word of an emergency: the goal ends, so that nothing drives off when it is over."""
        with self._lock:
            self._stopped = bool(message.data)
            if self._stopped and self._handle is not None:
                handle, self._handle = self._handle, None
                self._halt()
                handle.set_aborted(MoveBaseResult(), "emergency stop")

    def _halt(self) -> None:
        moving = self._navigator.phase is not Phase.IDLE
        self._navigator.stop()
        self._goal = None
        self._key += 1
        if moving:
            self._send(0.0, 0.0)

    def _take_simple_goal(self, message: PoseStamped) -> None:
        goal = MoveBaseActionGoal()
        goal.header.stamp = rospy.Time.now()
        goal.goal.target_pose = message
        self._action_goal.publish(goal)

    def _give_feedback(self) -> None:
        pose = self._world.robot_in_map()
        if self._handle is None or pose is None:
            return
        feedback = MoveBaseFeedback()
        feedback.base_position.header.frame_id = self._settings.world.frame
        feedback.base_position.header.stamp = rospy.Time.now()
        feedback.base_position.pose = pose_message(pose)
        self._handle.publish_feedback(feedback)

    def _is_path_blocked(self) -> bool:
        path, world = self._navigator.path, self._world.world
        return path is not None and world is not None and not path_is_free(world.costmap, path)

    def _make_plan(self, request: GetPlanRequest) -> GetPlanResponse:
        response = GetPlanResponse()
        response.plan.header.frame_id = self._settings.world.frame
        with self._lock:
            self._world.update()
            costs, here = self._world.costmaps(), self._world.robot_in_map()
        goal = self._goal_in_map(request.goal)
        start = self._goal_in_map(request.start) if request.start.header.frame_id else here
        if costs is None or not isinstance(goal, Pose2) or not isinstance(start, Pose2):
            problems = [x for x in (goal, start) if isinstance(x, str)]
            rospy.logerr("make_plan: %s", problems[0] if problems else "no map or no pose yet")
            return response
        answer = answer_request(PlanRequest(0, (start.x, start.y), (goal.x, goal.y), *costs), self._settings.planner)
        if answer.path is None:
            rospy.logerr("make_plan: %s", answer.reason)
        else:
            response.plan = path_message(answer.path, self._settings.world.frame)
        return response

    def _clear_costmaps(self, _request: EmptyRequest) -> EmptyResponse:
        with self._lock:
            self._forget_obstacles(Behaviour.CLEAR_ALL)
        return EmptyResponse()

    def _forget_obstacles(self, how: Behaviour) -> None:
        self._clear = None
        far = how is Behaviour.CLEAR_FAR
        motion = self._world.motion((0.0, 0.0), 0.0)
        self._world.local.clear(motion.pose if far and motion else None, self._settings.reset_distance)
        if self._world.world is not None:
            self._world.world.clear(self._world.robot_in_map() if far else None, self._settings.reset_distance)

    def _show(self) -> None:
        period = self._settings.navigator.period
        if self._due(self._settings.local.publish_frequency, period):
            motion = self._world.motion((0.0, 0.0), 0.0)
            if self._view.wants_costmap(local=True):
                self._view.show_costmap(self._world.local.inflated(), local=True)
            if motion is not None:
                self._view.show_footprint(self._settings.footprint, motion.pose, local=True)
        if self._due(self._settings.world.publish_frequency, period):
            self._show_world()

    def _show_world(self) -> None:
        world, pose = self._world.world, self._world.robot_in_map()
        if world is not None and self._view.wants_costmap(local=False) and self._shown != (id(world), world.changes):
            self._shown = (id(world), world.changes)
            self._view.show_costmap(world.costmap, local=False)
        if pose is not None:
            self._view.show_footprint(self._settings.footprint, pose, local=False)

    def _due(self, frequency: float, period: float) -> bool:
        return frequency > 0.0 and self._tick % max(1, round(1.0 / (frequency * period))) == 0

    def _shut_down(self) -> None:
        if self._navigator.phase is not Phase.IDLE:
            self._navigator.stop()
            self._send(0.0, 0.0)


def main() -> int:
    """Run the node until ROS ends it."""
    nodes: list[MoveBase] = []
    return run_node("move_base", lambda: nodes.append(MoveBase()))


if __name__ == "__main__":
    sys.exit(main())
