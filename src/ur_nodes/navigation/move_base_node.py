"""The node `move_base`: drives to goals. Stands in for the program of that name in the package `move_base`."""

from __future__ import annotations

import itertools
import sys
import threading
from typing import Any

import rospy
from actionlib import ActionServer
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionGoal, MoveBaseFeedback, MoveBaseResult
from nav_msgs.srv import GetPlan, GetPlanRequest, GetPlanResponse
from std_msgs.msg import Bool
from std_srvs.srv import Empty, EmptyRequest, EmptyResponse

from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory_use import return_large_arrays
from ur_nodes.navigation.goal_pose_node import goal_in_map, make_plan
from ur_nodes.navigation.goals.attendance import Act
from ur_nodes.navigation.goals.goal_claim import has_any_heading
from ur_nodes.navigation.goals.goal_watch_node import GoalWatch, read_watch_settings
from ur_nodes.navigation.move_base_parameters_node import read_settings
from ur_nodes.navigation.move_base_view_node import MoveBaseView
from ur_nodes.navigation.navigator import Navigator
from ur_nodes.navigation.navigator_step import Ending, Inputs, Outputs, Phase, PlanAnswer
from ur_nodes.navigation.plan_worker_node import PlanRequest, PlanWorker
from ur_nodes.navigation.planning.global_plan import path_is_free
from ur_nodes.navigation.recovery import Behaviour
from ur_nodes.navigation.rollout import FollowSettings
from ur_nodes.navigation.velocity_output_node import VelocityOutput
from ur_nodes.navigation.world_view_node import WorldView
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.geometry import pose_message
from ur_nodes.rosio.shell import run_node

_IDLE_PERIODS = 5  # control periods between two updates of the costmaps without a goal
_PATH_CHECK_PERIODS = 3  # likewise, between two checks of the path on the global costmap
_REPORT_PERIODS = 2  # likewise, between two messages of feedback
_RESTART = 1.0  # s: a clock that goes back by more has begun anew, as that of a simulator does


class MoveBase:
    """Takes goals as upstream does and steps the navigator at the controller frequency, in a thread of its own."""

    def __init__(self) -> None:
        self._settings = read_settings()
        watch = read_watch_settings(self._settings.mux)
        self._world = WorldView(self._settings)
        self._view = MoveBaseView(self._settings, self._world)
        self._navigator = Navigator(
            self._settings.navigator, self._settings.limits, FollowSettings(), self._settings.footprint
        )
        self._server = ActionServer("move_base", MoveBaseAction, self._on_goal, self._on_cancel, auto_start=False)
        self._server.publish_status = quiet_at_end(self._server.publish_status)  # a thread of its own calls it
        # The server calls back with its lock held, and takes it when a goal ends: a second lock would be a deadlock.
        self._lock = self._server.lock
        self._handle: Any = None  # of the goal that is pursued or held, as the server has it
        self._goal: Pose2 | None = None  # likewise, in the map
        self._key = 0  # of the newest request for a plan; answers to earlier ones are dropped
        self._answer: PlanAnswer | None = None  # that the next step of the navigator takes
        self._path_blocked = False
        self._sent = (0.0, 0.0)  # the last command, m/s and rad/s
        self._stopped = False  # by the emergency stop
        self._tick = 0  # of control periods
        self._worker = PlanWorker(self._settings.planner, self._on_plan)
        self._watch = GoalWatch(self._settings.mux, watch)
        self._output = VelocityOutput(self._watch.link, self._settings.mux, stamped=self._settings.stamped)
        self._action_goal = rospy.Publisher("move_base/goal", MoveBaseActionGoal, queue_size=1)
        rospy.Subscriber("move_base_simple/goal", PoseStamped, self._on_simple_goal, queue_size=1)
        rospy.Subscriber(f"{self._settings.mux}/stopped", Bool, self._on_stopped, queue_size=1)
        rospy.Service("~make_plan", GetPlan, self._make_plan)
        rospy.Service("~clear_costmaps", Empty, self._clear_costmaps)
        rospy.on_shutdown(self._shut_down)
        self._server.start()
        self._server.status_list_timeout = rospy.Duration(self._settings.status_kept)
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
                if now < last - _RESTART:
                    self._world.forget()
                last = now
                with self._lock:
                    self._control(now)
                self._view.show_surroundings(self._tick, self._lock)
                self._tick += 1
            else:
                self._repeat()
            try:
                rate.sleep()
            except rospy.ROSInterruptException:
                return

    def _repeat(self) -> None:
        """Repeat the last command: the mux takes an old one for the end of the commander."""
        with self._lock:
            if self._navigator.phase is not Phase.IDLE and self._sent != (0.0, 0.0):
                self._send(*self._sent)

    def _control(self, now: float) -> None:
        idle = self._navigator.phase is Phase.IDLE
        if not idle or self._tick % _IDLE_PERIODS == 0:
            self._world.update()
        if self._handle is None or not self._may_drive(now):
            return
        odom = self._world.odom()
        trouble = self._world.trouble(now)
        if self._tick % _PATH_CHECK_PERIODS == 0:
            self._path_blocked = self._is_path_blocked()
        answer, self._answer = self._answer, None
        out = self._navigator.step(
            Inputs(
                now=now,
                motion=self._world.motion(self._sent, now),
                odom=odom or Pose2(0.0, 0.0, 0.0),
                local=self._world.local_costmap.occupied(),
                answer=answer,
                trouble=trouble,
                path_blocked=self._path_blocked,
                speed_mask=self._world.zones.speed,
                share=self._output.share,
            )
        )
        self._apply(out)
        if answer is not None and answer.path is not None:
            self._path_blocked = False
            self._view.show_plan(answer.path)
        if self._tick % _REPORT_PERIODS == 0:
            self._view.show_drive(self._navigator.path, out.ahead)
            self._give_feedback()

    def _may_drive(self, now: float) -> bool:
        """Hold, cancel or continue the goal, as the watch decides. Return True when the navigator is to be stepped."""
        verdict = self._watch.judge()
        if verdict.act is Act.CANCEL:
            rospy.logwarn("the goal is cancelled: %s", verdict.text)
            self._halt()
            self._take_handle().set_canceled(MoveBaseResult(), verdict.text)
            return False
        self._handle.status_tracker.status.text = verdict.text
        idle = self._navigator.phase is Phase.IDLE
        if verdict.act is Act.DRIVE:
            if idle and self._goal is not None:
                rospy.loginfo("the goal goes on")
                self._start(self._goal, now)
            return True
        if not idle:
            rospy.logwarn("the goal is %s", verdict.text)
            self._halt(keep_goal=True)
            self._server.publish_status()
        if self._tick % _REPORT_PERIODS == 0:
            self._give_feedback()
        return False

    def _start(self, goal: Pose2, now: float) -> None:
        self._navigator.start(goal, now, any_heading=has_any_heading(self._handle.get_goal_id().id))

    def _take_handle(self) -> Any:
        """The goal's handle, which is to end now."""
        handle, self._handle = self._handle, None
        self._watch.finish()
        return handle

    def _apply(self, out: Outputs) -> None:
        if out.log:
            rospy.logwarn("%s", out.log)
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
        self._output.send(speed, turn)

    def _finish(self, ending: Ending, text: str) -> None:
        handle, self._goal = self._take_handle(), None
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

    def _on_plan(self, key: int, answer: PlanAnswer) -> None:
        with self._lock:
            if key == self._key:
                self._answer = answer

    def _on_goal(self, handle: Any) -> None:
        target = handle.get_goal().target_pose
        goal = goal_in_map(target, self._world.frames, self._settings.world.frame)
        with self._lock:
            before = self._watch.judge() if self._handle is not None else None  # it may belong to another client by now
            refusal = self._watch.accept(handle.get_goal_id().id)
            if refusal:  # it changes nothing for the goal that is pursued
                _refuse(handle, refusal)
                return
            old, self._handle = self._handle, None
            if old is not None:
                taken = before.text if before is not None and before.act is Act.CANCEL else ""
                old.set_canceled(MoveBaseResult(), taken or "a new goal has replaced this one")
            if self._stopped:
                goal = "emergency stop is on; release it first"
            if isinstance(goal, str):
                _refuse(handle, goal)
                self._watch.finish()
                self._halt()
                return
            handle.set_accepted()
            self._handle, self._goal, self._answer = handle, goal, None
            self._key += 1
            self._path_blocked = False
            self._start(goal, rospy.get_time())
            self._view.show_goal(goal)

    def _on_cancel(self, handle: Any) -> None:
        with self._lock:
            if self._handle is None or handle.get_goal_id().id != self._handle.get_goal_id().id:
                return
            self._take_handle()
            self._halt()
            handle.set_canceled(MoveBaseResult(), "cancelled")

    def _on_stopped(self, message: Bool) -> None:
        """React to an emergency stop: the goal ends, so that the robot does not drive off after the release."""
        with self._lock:
            self._stopped = bool(message.data)
            if self._stopped and self._handle is not None:
                self._halt()
                self._take_handle().set_aborted(MoveBaseResult(), "emergency stop")

    def _halt(self, *, keep_goal: bool = False) -> None:
        moving = self._navigator.phase is not Phase.IDLE
        self._navigator.stop()
        self._goal = self._goal if keep_goal else None
        self._answer = None
        self._key += 1
        if moving:
            self._send(0.0, 0.0)

    def _on_simple_goal(self, message: PoseStamped) -> None:
        goal = MoveBaseActionGoal()
        goal.header.stamp = rospy.Time.now()
        goal.goal.target_pose = message
        self._action_goal.publish(goal)

    def _give_feedback(self) -> None:
        pose = self._world.robot_in_map()
        if self._handle is None or pose is None:
            return
        position = PoseStamped(pose=pose_message(pose))
        position.header.frame_id, position.header.stamp = self._settings.world.frame, rospy.Time.now()
        self._handle.publish_feedback(MoveBaseFeedback(base_position=position))

    def _is_path_blocked(self) -> bool:
        path, world = self._navigator.path, self._world.global_costmap
        return path is not None and world is not None and not path_is_free(world.costmap, path)

    def _make_plan(self, request: GetPlanRequest) -> GetPlanResponse:
        with self._lock:
            self._world.update()
            costs, here = self._world.costmaps(), self._world.robot_in_map()
        return make_plan(request, self._world.frames, self._settings, costs, here)

    def _clear_costmaps(self, _request: EmptyRequest) -> EmptyResponse:
        with self._lock:
            self._forget_obstacles(Behaviour.CLEAR_ALL)
        return EmptyResponse()

    def _forget_obstacles(self, how: Behaviour) -> None:
        """Forget all obstacles, or with CLEAR_FAR those farther away than `reset_distance`."""
        far = how is Behaviour.CLEAR_FAR
        self._world.local_costmap.clear(self._world.robot_in_odom() if far else None, self._settings.reset_distance)
        if self._world.global_costmap is not None:
            self._world.global_costmap.clear(self._world.robot_in_map() if far else None, self._settings.reset_distance)

    def _shut_down(self) -> None:
        if self._navigator.phase is not Phase.IDLE:
            self._navigator.stop()
            self._send(0.0, 0.0)


def _refuse(handle: Any, reason: str) -> None:
    """End a goal that was never pursued."""
    rospy.logerr("goal refused: %s", reason)
    handle.set_accepted()
    handle.set_aborted(MoveBaseResult(), reason)


def main() -> int:
    """Run the node until ROS ends it."""
    nodes: list[MoveBase] = []
    return_large_arrays()
    return run_node("move_base", lambda: nodes.append(MoveBase()))


if __name__ == "__main__":
    sys.exit(main())
