"""Goals of `move_base`: accepted as by upstream, and pursued by the navigator, which is stepped at a constant rate."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.costmap import Costmap
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.transform_tree import TransformError, TransformTree
from ur_nodes.motion.challenge.link import ChallengeLink, FreshPublisher
from ur_nodes.navigation.contacts import ContactSense
from ur_nodes.navigation.goals import attendance
from ur_nodes.navigation.goals.attendance import Act
from ur_nodes.navigation.goals.goal_claim import has_any_heading
from ur_nodes.navigation.goals.goal_watch import GoalWatch
from ur_nodes.navigation.move_base_settings import MoveBaseSettings
from ur_nodes.navigation.move_base_view import MoveBaseView, make_path
from ur_nodes.navigation.navigator import Navigator
from ur_nodes.navigation.navigator_step import Ending, NavigatorInputs, NavigatorOutputs, NavigatorPhase, PlanAnswer
from ur_nodes.navigation.plan_request import PlanRequest, answer_request
from ur_nodes.navigation.planning.global_plan import path_is_free
from ur_nodes.navigation.planning.outline_motions import Steering
from ur_nodes.navigation.steering.recovery import Behaviour
from ur_nodes.navigation.steering.speed_profile import AT_REST, DriveVelocity
from ur_nodes.navigation.world_view import WorldView
from ur_nodes.ports.actions import GoalHandle, GoalServer
from ur_nodes.ports.newest_work import NewestWork
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskPath, ClearCostmap, Silent
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.validation import problem_of
from ur_nodes.ports.values import Path, Result, StampedPose, Twist


class VelocityOutput:
    """Publishes on `cmd_vel`, or on the same name with `_stamped` appended.

    Commands are stamped with the newest challenge, which bounds their age, as soon as the mux has subscribed to them;
    after that they are never plain. A base without our mux has no subscriber there and gets plain ones. This node
    drives for the holder of the lease, so that its commands name no client. `share` (0 to 1) is how much of the base's
    speeds the mux lets through: a plan for more would not be kept.
    """

    def __init__(self, link: ChallengeLink, mux: str, *, stamped: bool) -> None:
        """Without `stamped`, commands are always plain."""
        self.share = 1.0
        link.node.subscribe(f"{mux}/speed_limit_in_force", float, self._on_limit, Quality.LATCHED)
        self._plain = link.node.publish("cmd_vel", Twist)
        self._stamped = FreshPublisher("cmd_vel", link) if stamped else None
        self._to_mux = False

    def _on_limit(self, percent: float) -> None:
        self.share = percent / 100.0 if 0.0 < percent <= 100.0 else 1.0

    def send(self, velocity: DriveVelocity) -> bool:
        """Publish a command. Return False without a fresh challenge: nothing is sent, and the robot stops."""
        self._to_mux = self._to_mux or (self._stamped is not None and self._stamped.subscribers() > 0)
        if self._stamped is None or not self._to_mux:
            self._plain.send(Twist(*velocity))
            return True
        return self._stamped.send(Twist(*velocity))


_HOLD = 1.0  # s by which transforms may be older than a goal, which is stamped as it is sent


def goal_in_map(target: StampedPose, frames: TransformTree, map_frame: str) -> Pose2 | str:
    """Return the goal's pose in the map, or why it cannot be used."""
    goal = target.pose
    if problem := problem_of(target):
        return f"unusable goal: {problem}"
    if not target.frame:
        return f"the goal has no frame_id, expected {map_frame}"
    if target.frame == map_frame:
        return goal
    try:
        place = frames.pose(map_frame, target.frame, seconds_of(target.stamp) or None, hold=_HOLD)
    except TransformError as problem:
        return f"the goal is in the frame {target.frame}: {problem}"
    return place.compose(goal)


def read_request(
    request: AskPath,
    frames: TransformTree,
    map_frame: str,
    costs: tuple[Costmap, Costmap, Costmap | None] | None,
    here: Pose2 | None,
) -> PlanRequest | str:
    """Return a request of `~make_plan` in the map, or why there is no path.

    `costs` are the costmaps of `WorldView.costmaps`, `here` the robot in the map, for a request without a start.
    """
    goal = goal_in_map(request.goal, frames, map_frame)
    start = goal_in_map(request.start, frames, map_frame) if request.start.frame else here
    for each in (goal, start):
        if isinstance(each, str):
            return each
    if costs is None or not isinstance(goal, Pose2) or not isinstance(start, Pose2):
        return "no map or no pose yet"
    return PlanRequest(0, (start.x, start.y), (goal.x, goal.y), *costs)


_IDLE_PERIODS = 5  # control periods between two updates of the costmaps without a goal
_PATH_CHECK_PERIODS = 3  # likewise, between two checks of the path on the global costmap
_REPORT_PERIODS = 2  # likewise, between two reports of the robot's pose
_NO_MUX = 5.0  # s without a challenge, after which goals are taken without a mux; a mux on ROS 2 starts in up to 4 s
_WIDER = 0.2, 0.3  # m to both sides by which more is marked when the robot touches something, and touches it again
_RESTART = 1.0  # s: a clock that goes back by more was reset, as by a simulator


class MoveBase:
    """Pursues one goal at a time. `beat` is to be called `repeats` times a control period."""

    def __init__(self, node: Node, settings: MoveBaseSettings, watch: attendance.AttendanceSettings) -> None:
        self._node = node
        self._settings = settings
        outline = settings.footprint.outline
        self._contacts = ContactSense(
            node, settings.base_frame, outline, settings.bumpers, settings.imu_topic, settings.mux
        )
        self._world = WorldView(node, settings, self._contacts.see)
        self._touches = 0  # of the goal
        self._place: Pose2 | None = None  # of the last period, in the odometry frame
        self._view = MoveBaseView(node, settings, self._world)
        self._navigator = Navigator(settings.navigator, settings.limits, settings.footprint)
        self._handle: GoalHandle | None = None  # of the goal that is pursued or held
        self._goal: Pose2 | None = None  # likewise, in the map
        self._key = 0  # of the newest request for a plan; answers to earlier ones are dropped
        self._answer: PlanAnswer | None = None  # that the next step of the navigator takes
        self._path_blocked = False
        self._sent = AT_REST  # the last command
        self._in_force = AT_REST  # the last command, if it was sent
        self._stopped = False  # by the emergency stop
        self._beats = 0
        self._tick = 0  # of control periods
        self._last = 0.0  # s: the time of the last one
        self._plans = NewestWork(node, "plans", self._plan, self._on_plan)
        self._server: GoalServer | None = None  # of the goals that clients send
        self._watch = GoalWatch(node, settings.mux, watch, self._offer_goals)
        self._output = VelocityOutput(self._watch.link, settings.mux, stamped=settings.stamped)
        node.after(_NO_MUX, self._offer_goals, steady=True)

    def use(self, settings: MoveBaseSettings) -> None:
        """Use changed settings from the next period on."""
        self._settings = settings
        self._navigator.use(settings.navigator, settings.limits)
        self._world.use(settings)

    def beat(self) -> None:
        """Step the navigator, or repeat the last command, which the mux would otherwise time out."""
        self._beats += 1
        if self._beats % self._settings.repeats != 1 % self._settings.repeats:
            if self._navigator.phase is not NavigatorPhase.IDLE and self._sent != AT_REST:
                self._send(self._sent)
            return
        now = self._now()
        if now < self._last - _RESTART:
            self._world.forget()
        self._last = now
        self._control(now)
        self._view.show_surroundings(self._tick)
        self._tick += 1

    def handle_goal(self, handle: GoalHandle) -> None:
        """Pursue this goal in place of another, or refuse it."""
        goal = goal_in_map(handle.goal.target, self._world.frames, self._settings.world.frame)
        before = self._watch.judge() if self._handle is not None else None  # it may belong to another client by now
        refusal = self._watch.accept(handle.goal.id)
        if refusal:  # it changes nothing for the goal that is pursued
            self._refuse(handle, refusal)
            return
        old, self._handle = self._handle, None
        if old is not None:
            taken = before.text if before is not None and before.act is Act.CANCEL else ""
            old.cancel(taken or "a new goal has replaced this one")
        if self._stopped:
            goal = "emergency stop is on; release it first"
        if isinstance(goal, str):
            self._refuse(handle, goal)
            self._watch.finish()
            self._halt()
            return
        handle.accept()
        self._handle, self._goal, self._answer = handle, goal, None
        self._key += 1
        self._path_blocked, self._touches = False, 0
        self._navigator.start(goal, self._now(), any_heading=has_any_heading(handle.goal.id))
        self._view.show_goal(goal)
        self._control_if_standing()

    def handle_cancel(self, handle: GoalHandle) -> None:
        """Stop, and end the goal."""
        if handle is self._handle:
            self._end_goal()
            self._halt()
            handle.cancel("cancelled")

    def on_stop(self, stopped: bool) -> None:
        """End the goal after an emergency stop, so that the robot does not move after the release."""
        self._stopped = stopped
        if stopped and self._handle is not None:
            handle = self._handle
            self._halt()
            self._end_goal()
            handle.abort("emergency stop")

    def make_plan(self, request: AskPath, reply: Callable[[Result], None]) -> None:
        """Plan without driving; without a path, the answer has no poses and the log has the reason."""
        self._world.update()
        costs, here, frame = self._world.costmaps(), self._world.robot_in_map(), self._settings.world.frame
        wanted = read_request(request, self._world.frames, frame, costs, here)

        def answer(found: PlanAnswer) -> None:
            if found.path is None:
                self._node.log.error(f"make_plan: {found.reason}")
                reply(Result(True, value=Path(0, frame, np.empty((0, 3)))))
            else:
                reply(Result(True, value=make_path(found.path, frame, self._node.now())))

        if isinstance(wanted, str):
            answer(PlanAnswer(None, wanted))
        else:
            self._node.work(partial(self._plan, wanted), answer, "requests")

    def clear_costmaps(self, _request: Silent | ClearCostmap) -> Result:
        """Clear all obstacles that were seen."""
        self._world.clear_touched()
        self._forget_obstacles(Behaviour.CLEAR_ALL)
        return Result(success=True)

    def shut_down(self) -> None:
        """Stop the robot."""
        if self._navigator.phase is not NavigatorPhase.IDLE:
            self._navigator.stop()
            self._send(AT_REST)

    def _offer_goals(self) -> None:
        """Start to accept goals; after the first challenge, those that answer one have an age."""
        if self._server is None:
            self._server = self._node.serve_goals("move_base", self, self._settings.status_kept)

    def _now(self) -> float:
        return seconds_of(self._node.now())

    def _control(self, now: float) -> None:
        idle = self._navigator.phase is NavigatorPhase.IDLE
        if not idle or self._tick % _IDLE_PERIODS == 0:
            self._world.update()
        contact = self._feel(now)
        if self._handle is None or not self._may_drive(self._handle, now):
            return
        if self._tick % _PATH_CHECK_PERIODS == 0:
            path, world = self._navigator.path, self._world.global_costmap
            self._path_blocked = path is not None and world is not None and not path_is_free(world.costmap, path)
        answer, self._answer = self._answer, None
        before, beside = self._navigator.phase, self._contacts.beside(self._world.touched_in_base(), self._widening)
        out = self._navigator.step(
            NavigatorInputs(
                now=now,
                motion=self._world.motion(self._sent, now),
                odom=self._world.odom() or Pose2(0.0, 0.0, 0.0),
                local=self._world.surroundings(now),
                answer=answer,
                trouble=self._world.trouble(now) or ("" if contact else self._held()),
                path_blocked=self._path_blocked,
                speed_mask=self._world.zones.speed,
                share=self._output.share,
                contact=contact,
                beside=beside is not None,
            )
        )
        if beside is not None and not contact and before is not self._navigator.phase is NavigatorPhase.BACKING_OFF:
            self._touch(beside)  # the marks of before did not lead around it
        self._apply(out)
        if answer is not None and answer.path is not None:
            self._path_blocked = False
            self._view.show_plan(answer.path)
        if self._tick % _REPORT_PERIODS == 0:
            self._view.show_drive(self._navigator.path, out.ahead)
            self._report()

    def _feel(self, now: float) -> str:
        """Mark what the robot touches, a wider part each time during a goal; return how it was stopped."""
        place, before = self._world.robot_in_odom(), self._place
        self._place = place
        moved = before.inverse().compose(place) if before and place else Pose2(0.0, 0.0, 0.0)
        velocity = DriveVelocity(moved.x, moved.yaw, moved.y)
        contact = self._contacts.step(now, self._in_force, place, velocity, self._widening)
        if contact is None:
            return ""
        self._touch(contact.points)
        return contact.text

    @property
    def _widening(self) -> float:
        return _WIDER[min(self._touches, 1)]

    def _touch(self, points: NDArray[np.float64]) -> None:
        self._world.touch(points)
        self._touches += self._handle is not None

    def _held(self) -> str:
        """Return the reason not to drive on while a bumper stays pressed after the robot has backed off."""
        return "" if self._navigator.phase is NavigatorPhase.BACKING_OFF else self._contacts.held

    def _may_drive(self, handle: GoalHandle, now: float) -> bool:
        """Hold, cancel or continue the goal, as the watch decides. Return whether to step the navigator."""
        verdict = self._watch.judge()
        if verdict.act is Act.CANCEL:
            self._node.log.warn(f"the goal is cancelled: {verdict.text}")
            self._halt()
            self._end_goal()
            handle.cancel(verdict.text)
            return False
        handle.note(verdict.text)
        idle = self._navigator.phase is NavigatorPhase.IDLE
        if verdict.act is Act.DRIVE:
            if idle and self._goal is not None:
                self._node.log.info("the goal goes on")
                self._navigator.start(
                    self._goal, now, any_heading=has_any_heading(handle.goal.id), contacts=self._touches
                )
            return True
        if not idle:
            self._node.log.warn(f"the goal is {verdict.text}")
            self._halt(keep_goal=True)
            if self._server is not None:
                self._server.publish_status()
        if self._tick % _REPORT_PERIODS == 0:
            self._report()
        return False

    def _end_goal(self) -> None:
        self._handle = None
        self._watch.finish()

    def _apply(self, out: NavigatorOutputs) -> None:
        if out.log:
            self._node.log.warn(out.log)
        if out.clear is not None:
            self._forget_obstacles(out.clear)
        if out.command is not None:
            self._send(out.command)
        if out.plan:
            self._ask_for_plan(careful=out.careful, waited=out.waited)
        if out.ending is not None:
            self._finish(out.ending, out.text)

    def _send(self, velocity: DriveVelocity) -> None:
        self._sent = velocity
        self._in_force = velocity if self._output.send(velocity) else AT_REST

    def _finish(self, ending: Ending, text: str) -> None:
        handle, self._goal = self._handle, None
        assert handle is not None
        self._end_goal()
        if ending is Ending.REACHED:
            self._node.log.info(text)
            handle.succeed(text)
        else:
            self._node.log.error(f"gave up: {text}")
            handle.abort(text)

    def _ask_for_plan(self, *, careful: bool, waited: float) -> None:
        pose, costs = self._world.robot_in_map(), self._world.costmaps()
        if pose is None or costs is None or self._goal is None:
            return
        self._key += 1
        heading = None if self._handle and has_any_heading(self._handle.goal.id) else self._goal.yaw
        place, goal = (pose.x, pose.y), (self._goal.x, self._goal.y)
        people = self._world.people_in_map(self._now())
        request = PlanRequest(
            self._key, place, goal, *costs, yaw=pose.yaw, heading=heading, careful=careful, people=people, waited=waited
        )
        if self._world.global_costmap is not None and self._world.touched:
            request = replace(request, untouched=self._world.global_costmap.untouched)
        self._plans.ask(request)

    def _plan(self, request: PlanRequest) -> PlanAnswer:
        limits = self._settings.limits
        steering = Steering(limits.radius, sideways=limits.lateral > 0.0, bend=limits.bend)
        return answer_request(request, self._settings.planner, self._settings.footprint, steering)

    def _on_plan(self, request: PlanRequest, answer: PlanAnswer) -> None:
        if request.key == self._key:
            self._answer = answer
            if self._navigator.phase is NavigatorPhase.PLANNING:
                self._control_if_standing()

    def _control_if_standing(self) -> None:
        """Step the navigator without waiting for the next period, which begins anew."""
        if self._sent == AT_REST:
            self._beats = 0
            self.beat()

    def _halt(self, *, keep_goal: bool = False) -> None:
        moving = self._navigator.phase is not NavigatorPhase.IDLE
        self._navigator.stop()
        self._goal = self._goal if keep_goal else None
        self._answer = None
        self._key += 1
        if moving:
            self._send(AT_REST)

    def _refuse(self, handle: GoalHandle, reason: str) -> None:
        self._node.log.error(f"goal refused: {reason}")
        handle.refuse(reason)

    def _report(self) -> None:
        pose = self._world.robot_in_map()
        if self._handle is not None and pose is not None:
            self._handle.report(StampedPose(self._node.now(), self._settings.world.frame, pose))

    def _forget_obstacles(self, how: Behaviour) -> None:
        """Clear all obstacles, or with CLEAR_FAR those farther away than `reset_distance`."""
        far, distance = how is Behaviour.CLEAR_FAR, self._settings.reset_distance
        self._world.local_costmap.clear(self._world.robot_in_odom() if far else None, distance)
        if self._world.global_costmap is not None:
            self._world.global_costmap.clear(self._world.robot_in_map() if far else None, distance)
