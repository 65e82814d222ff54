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
from ur_nodes.navigation.goal_pose_node import goal_in_map, make_plan
from ur_nodes.navigation.goals.attendance import Act
from ur_nodes.navigation.goals.goal_watch_node import GoalWatch, read_watch_settings
from ur_nodes.navigation.local_plan import FollowSettings
from ur_nodes.navigation.move_base_parameters_node import read_settings
from ur_nodes.navigation.move_base_view_node import MoveBaseView
from ur_nodes.navigation.navigator import Navigator
from ur_nodes.navigation.navigator_step import Ending, Inputs, Outputs, Phase, PlanAnswer
from ur_nodes.navigation.plan_worker_node import PlanRequest, PlanWorker
from ur_nodes.navigation.planning.global_plan import path_is_free
from ur_nodes.navigation.recovery import Behaviour
from ur_nodes.navigation.velocity_output_node import VelocityOutput
from ur_nodes.navigation.world_view_node import WorldView
from ur_nodes.rosio.freed_memory import return_large_arrays
from ur_nodes.rosio.geometry import pose_message
from ur_nodes.rosio.shell import run_node


class MoveBase:
    """Takes goals as upstream does and steps the navigator at the controller frequency, in a thread of its own."""

    def __init__(self) -> None:
        self._settings = read_settings()
        watch = read_watch_settings(self._settings.mux)
        self._view = MoveBaseView(self._settings.world.frame, self._settings.local.frame)
        self._world = WorldView(self._settings)
        self._navigator = Navigator(
            self._settings.navigator, self._settings.limits, FollowSettings(), self._settings.footprint
        )
        self._server = ActionServer("move_base", MoveBaseAction, self._on_goal, self._on_cancel, auto_start=False)
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
        self._shown = 0
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
        """Repeat the last command: the mux takes an old one for the end of the commander."""
        with self._lock:
            if self._navigator.phase is not Phase.IDLE and self._sent != (0.0, 0.0):
                self._send(*self._sent)

    def _control(self, now: float) -> None:
        idle = self._navigator.phase is Phase.IDLE
        if not idle or self._tick % 5 == 0:
            self._world.update()
        if self._clear is not None:
            self._forget_obstacles(self._clear)
        if self._handle is None or not self._may_drive(now):
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
                speed_mask=self._world.zones.speed,
                share=self._output.share,
            )
        )
        self._apply(out)
        if answer is not None and answer.path is not None:
            self._path_blocked = False
            self._view.show_plan(answer.path)
        if self._tick % 2 == 0:
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
                self._navigator.start(self._goal, now)
            return True
        if not idle:
            rospy.logwarn("the goal is %s", verdict.text)
            self._halt(keep_goal=True)
            self._server.publish_status()
        if self._tick % 2 == 0:
            self._give_feedback()
        return False

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
                rospy.logerr("goal refused: %s", refusal)
                handle.set_accepted()
                handle.set_aborted(MoveBaseResult(), refusal)
                return
            old, self._handle = self._handle, None
            if old is not None:
                taken = before.text if before is not None and before.act is Act.CANCEL else ""
                old.set_canceled(MoveBaseResult(), taken or "a new goal has replaced this one")
            if self._stopped:
                goal = "emergency stop is on; release it first"
            if isinstance(goal, str):
                rospy.logerr("goal refused: %s", goal)
                handle.set_accepted()
                handle.set_aborted(MoveBaseResult(), goal)
                self._watch.finish()
                self._halt()
                return
            handle.set_accepted()
            self._handle, self._goal, self._answer = handle, goal, None
            self._key += 1
            self._path_blocked = False
            self._navigator.start(goal, rospy.get_time())
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
        feedback = MoveBaseFeedback()
        feedback.base_position.header.frame_id = self._settings.world.frame
        feedback.base_position.header.stamp = rospy.Time.now()
        feedback.base_position.pose = pose_message(pose)
        self._handle.publish_feedback(feedback)

    def _is_path_blocked(self) -> bool:
        path, world = self._navigator.path, self._world.world
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
        if world is not None and self._view.wants_costmap(local=False):
            with self._lock:
                changed = world.take_changes()
            self._view.show_world(world.costmap, changed, new=self._shown != self._world.maps)
            self._shown = self._world.maps
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
    return_large_arrays()
    return run_node("move_base", lambda: nodes.append(MoveBase()))


if __name__ == "__main__":
    sys.exit(main())
