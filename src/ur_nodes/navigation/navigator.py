"""The navigator of a goal: plan, drive, turn, recover, give up. Pure: time comes with the inputs."""

import math
from dataclasses import replace

import numpy as np

from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.leg_follower import Driving, LegFollower
from ur_nodes.navigation.navigator_step import (
    Ending,
    NavigatorInputs,
    NavigatorOutputs,
    NavigatorPhase,
    NavigatorSettings,
    PlanAnswer,
)
from ur_nodes.navigation.people.tracked_people import NO_PEOPLE, leads_to_standing, room_to_people
from ur_nodes.navigation.planning.legs import Leg
from ur_nodes.navigation.planning.outline_plan import is_long
from ur_nodes.navigation.planning.path_geometry import Points
from ur_nodes.navigation.pursuit import DrivenTrack, GoalPursuit, blocked_at
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.local_plan import sweep_is_free
from ur_nodes.navigation.steering.recovery import SEQUENCE, Behaviour, Recovery, begin_recovery, move_to_recover
from ur_nodes.navigation.steering.rollout import RolloutState, follow_settings
from ur_nodes.navigation.steering.speed_profile import (
    AT_REST,
    DriveVelocity,
    SpeedLimits,
    brake,
    limit_speeds,
    turn_towards,
)

_ASTRAY, _ASTRAY_TIGHT = 0.4, 0.15  # m beside a path, and beside one that was made for the outline
_SHUNTED, _MOST_SHUNTS = 0.12, 5  # rad off a heading, and manoeuvres for it, without turns on the spot
_WAIT_PAUSE = 1.0  # s between two plans while people are in the way
_AHEAD, _NEXT = 60, 30  # points of the path that people may stand on, also where the robot has made room for them
_TIGHT_PAUSE = 2.0  # s between plans of such a path, which take longer
_MOST_CONTACTS = 3  # with what the lidar does not see
_BACKING = 5.0, 2.0  # s to back off at most, and at first, in which the same contact comes again
_ROOMY, _PASSED, _STAY = 1.3, 0.7, 6.0  # m to people who left, or left the path, and s to make room at most


class Navigator:
    """Pursues one goal at a time. Call `step` once per control period; deterministic."""

    def __init__(self, settings: NavigatorSettings, limits: SpeedLimits, footprint: Footprint) -> None:
        self.use(settings, limits)
        self._footprint = footprint
        self._track = DrivenTrack()
        self._run: GoalPursuit | None = None

    def use(self, settings: NavigatorSettings, limits: SpeedLimits) -> None:
        """Use other settings from the next step on, for the present goal too."""
        self._settings = settings
        self._limits = self._highest = limits
        self._follow = follow_settings(limits)
        self._share = 1.0

    @property
    def phase(self) -> NavigatorPhase:
        """The present phase."""
        return self._run.phase if self._run else NavigatorPhase.IDLE

    @property
    def path(self) -> Points | None:
        """The path (n, 2) in the map that is being followed, from the robot on, if there is one."""
        run = self._run
        return run.legs.rest if run and run.legs is not None else None

    def start(self, goal: Pose2, now: float, *, any_heading: bool = False, contacts: int = 0) -> None:
        """Pursue a goal (a pose in the map) in place of an earlier one; the motion continues smoothly.

        `any_heading`: it is reached at its place with any heading. `contacts` were made on the way to it before.
        """
        sent = self._run.sent if self._run else AT_REST
        self._run = GoalPursuit(
            goal, NavigatorPhase.PLANNING, now, any_heading, sent=sent, moved_at=now, contacts=contacts
        )

    def stop(self) -> None:
        """Drop the goal. The caller stops the robot."""
        self._run = None

    def step(self, inputs: NavigatorInputs) -> NavigatorOutputs:
        """Run one control period. After an ending, the navigator is idle and the caller stops the robot."""
        run = self._run
        if run is None:
            return NavigatorOutputs()
        if inputs.share != self._share:
            self._share, self._limits = inputs.share, limit_speeds(self._highest, inputs.share)
        stopped = self._check_trouble(run, inputs)
        if stopped is not None:
            return stopped
        assert inputs.motion is not None
        assert inputs.local is not None
        self._track.remember(inputs.motion.pose)
        run.recovery = run.recovery.forgotten(inputs.motion.pose, self._settings.progress_distance)
        if inputs.answer is not None:
            ended = self._on_answer(run, inputs.answer, inputs)
            if ended is not None:
                return ended
        if inputs.contact and not (
            run.phase is NavigatorPhase.BACKING_OFF and inputs.now - run.phase_since < _BACKING[1]
        ):
            return self._on_contact(run, inputs.contact, inputs)
        step = {
            NavigatorPhase.BACKING_OFF: self._back_off,
            NavigatorPhase.PLANNING: self._plan,
            NavigatorPhase.DRIVING: self._drive,
            NavigatorPhase.TURNING: self._turn,
            NavigatorPhase.RECOVERING: self._recover,
            NavigatorPhase.MAKING_ROOM: self._make_room,
        }[run.phase]
        out = step(run, inputs.motion, inputs.local, inputs)
        if out.command is not None and self._limits.radius:
            out = replace(out, command=DriveVelocity(out.command.speed, self._limits.turn_at(*out.command[:2])))
        run.sent = out.command or AT_REST
        if out.plan:
            run.asked = run.last_asked = inputs.now
        return out

    def _check_trouble(self, run: GoalPursuit, inputs: NavigatorInputs) -> NavigatorOutputs | None:
        trouble = inputs.trouble or ("" if inputs.motion and inputs.local else "no pose of the robot")
        if not trouble:
            run.trouble_since = None
            return None
        first = run.trouble_since is None
        if run.trouble_since is None:
            run.trouble_since = inputs.now
        run.sent = AT_REST
        run.moved_at = inputs.now
        if inputs.now - run.trouble_since > self._settings.trouble_patience:
            return self._end(Ending.FAILED, trouble)
        return NavigatorOutputs(command=AT_REST, log=f"stopped: {trouble}" if first else "")

    def _on_answer(self, run: GoalPursuit, answer: PlanAnswer, inputs: NavigatorInputs) -> NavigatorOutputs | None:
        run.asked = None
        if answer.path is not None:
            run.path, run.last_turn, run.reason = answer.path, answer.last_turn, ""
            run.legs = LegFollower(answer.legs or (Leg(answer.path),))
            if run.phase in (NavigatorPhase.PLANNING, NavigatorPhase.TURNING):
                run.enter(NavigatorPhase.DRIVING, inputs.now)
            return None
        run.reason = answer.reason
        if answer.hopeless:
            return self._end(Ending.FAILED, answer.reason)
        return None

    def _plan(
        self, run: GoalPursuit, _motion: RolloutState, _local: LocalObstacles, inputs: NavigatorInputs
    ) -> NavigatorOutputs:
        if inputs.now - run.phase_since > self._settings.planner_patience:
            return self._get_stuck(run, inputs, run.reason or "planning took too long")
        return NavigatorOutputs(self._braked(run), plan=run.may_ask(inputs.now, 0.5), waited=run.waited(inputs.now))

    def _drive(
        self, run: GoalPursuit, motion: RolloutState, local: LocalObstacles, inputs: NavigatorInputs
    ) -> NavigatorOutputs:
        assert run.legs is not None
        pose = motion.pose
        held = RolloutState(pose, *run.sent)
        driven = run.legs.step(held, local, inputs.odom, inputs.speed_mask, self._driving)
        if driven.ended or (driven.command.waits and run.is_at_end(pose, inputs.odom, self._settings.xy_tolerance)):
            if not driven.ended or driven.away <= self._settings.xy_tolerance:
                run.waited_since = None
                run.enter(NavigatorPhase.TURNING, inputs.now)
                return self._turn(run, motion, local, inputs)
            return NavigatorOutputs(command=self._braked(run), plan=run.may_ask(inputs.now, 0.5))
        step = driven.command
        if step.waits:
            return self._wait(run, step.velocity, inputs, step.ahead)
        run.drive_on(pose)
        patience = self._settings
        if run.contacts:  # more pushing does not help
            patience = replace(patience, controller_patience=2.0, progress_timeout=4.0)
        if run.is_stuck(step.blocked, inputs.now, pose, patience):
            return self._get_stuck(run, inputs, run.reason or blocked_at(pose, inputs.odom))
        astray = driven.away > (_ASTRAY_TIGHT if run.legs.is_tight else _ASTRAY)
        tight = run.legs.is_tight  # of such a path another variant is no reason for another path
        hindered = (step.hindered and not tight) or self._leads_to_people(run, inputs.odom, local, _AHEAD)
        wanted = (hindered or step.blocked or astray or inputs.path_blocked) and run.may_ask(
            inputs.now, _TIGHT_PAUSE if tight else 0.5 if step.blocked else 1.0
        )
        periodic = self._settings.planner_period > 0.0 and run.may_ask(inputs.now, self._settings.planner_period)
        plan, waited = wanted or periodic, run.waited(inputs.now)
        return NavigatorOutputs(step.velocity, plan=plan, careful=step.blocked, waited=waited, ahead=step.ahead)

    def _wait(
        self, run: GoalPursuit, command: DriveVelocity, inputs: NavigatorInputs, ahead: Points | None = None
    ) -> NavigatorOutputs:
        """Stop for people, who will move on; search for a path around them, and make room for those who cannot."""
        assert inputs.motion is not None
        waited = run.wait(inputs.now, inputs.motion.pose)
        if waited > self._settings.people_patience:
            return self._get_stuck(run, inputs, "people are in the way")
        if run.begin_to_make_room(inputs, waited, self._driving, self._track):
            run.enter(NavigatorPhase.MAKING_ROOM, inputs.now)
            return NavigatorOutputs(command=self._braked(run), log="making room for people")
        return NavigatorOutputs(
            command=command,
            plan=run.phase is NavigatorPhase.DRIVING and run.may_ask(inputs.now, _WAIT_PAUSE),
            waited=waited,
            ahead=ahead,
            log="" if waited else "waiting for people",
        )

    def _make_room(
        self, run: GoalPursuit, motion: RolloutState, local: LocalObstacles, inputs: NavigatorInputs
    ) -> NavigatorOutputs:
        """Drive the own track back, and stay there until people have left, or for a while."""
        assert run.retreat is not None
        held = RolloutState(motion.pose, *run.sent)
        back = run.retreat.step(held, local, Pose2(0.0, 0.0, 0.0), None, self._driving)
        room = room_to_people(motion.pose, local.people, self._footprint)
        enough = _ROOMY if self._leads_to_people(run, inputs.odom, local, _NEXT) else _PASSED
        if back.command.blocked or room > enough or inputs.now - run.phase_since > _STAY:
            run.enter(NavigatorPhase.PLANNING, inputs.now)
            return NavigatorOutputs(self._braked(run), plan=run.may_ask(inputs.now, 0.5), waited=run.waited(inputs.now))
        return NavigatorOutputs(command=back.command.velocity)

    def _turn(
        self, run: GoalPursuit, motion: RolloutState, local: LocalObstacles, inputs: NavigatorInputs
    ) -> NavigatorOutputs:
        if run.path is not None:  # it may end beside a goal that cannot be reached
            x, y = run.path[-1].tolist()
            end = inputs.odom.compose(Pose2(x, y, run.goal.yaw))
        else:
            end = inputs.odom.compose(run.goal)
        error = 0.0 if run.any_heading else wrap_angle(end.yaw - motion.pose.yaw)
        if self._limits.radius:
            return self._end_shunting(run, error, inputs)
        planned = run.last_turn or 0.0
        if abs(planned) > 2.0 and error * planned < 0.0 and abs(error) > 0.3:  # the other way may be blocked
            error += math.copysign(math.tau, planned)
        away = math.hypot(end.x - motion.pose.x, end.y - motion.pose.y)
        braked = self._braked(run)
        resting = math.hypot(braked.speed, braked.left) < 0.02
        if resting and away > self._settings.xy_tolerance:
            run.enter(NavigatorPhase.PLANNING, inputs.now)
            return NavigatorOutputs(command=self._braked(run), plan=run.may_ask(inputs.now, 0.5))
        if abs(error) < 0.3 * self._settings.yaw_tolerance and resting and abs(run.sent.turn) < 0.15:
            return self._end(Ending.REACHED, "goal reached")
        turn = turn_towards(error, run.sent.turn, self._limits, self._settings.period)
        trial = RolloutState(motion.pose, 0.0, turn)
        free = abs(turn) < 0.02 or sweep_is_free(trial, 0.3, local, self._footprint)
        if free and run.waited_since is not None:  # the rest of it, too: else it turns a little and waits again
            rest = RolloutState(motion.pose, 0.0, math.copysign(self._limits.turn, error))
            free = sweep_is_free(rest, abs(error) / self._limits.turn, local, self._footprint)
        if not free and sweep_is_free(trial, 0.3, replace(local, people=NO_PEOPLE), self._footprint):
            return self._wait(run, braked, inputs)
        run.waited_since = None
        if run.is_stuck(not free, inputs.now, motion.pose, self._settings):
            return self._get_stuck(run, inputs, "no room to turn at the goal")
        return NavigatorOutputs(command=braked._replace(turn=turn) if free else braked)

    def _end_shunting(self, run: GoalPursuit, error: float, inputs: NavigatorInputs) -> NavigatorOutputs:
        """End at rest where the heading is about right, without turning on the spot; else drive back and forth."""
        if run.sent != AT_REST:
            return NavigatorOutputs(command=self._braked(run))
        if abs(error) < max(_SHUNTED, self._settings.yaw_tolerance):
            return self._end(Ending.REACHED, "goal reached")
        run.shunts += 1
        if run.shunts > _MOST_SHUNTS:
            return self._get_stuck(run, inputs, f"{math.degrees(abs(error)):.0f} degrees off the heading of the goal")
        run.enter(NavigatorPhase.PLANNING, inputs.now)
        return NavigatorOutputs(command=AT_REST, plan=run.may_ask(inputs.now, 0.5))

    def _recover(
        self, run: GoalPursuit, motion: RolloutState, local: LocalObstacles, inputs: NavigatorInputs
    ) -> NavigatorOutputs:
        behaviour = run.recovery.behaviour
        assert behaviour is not None
        if behaviour in (Behaviour.CLEAR_FAR, Behaviour.CLEAR_ALL):
            run.end_recovery(motion.pose, inputs.now)
            return NavigatorOutputs(command=AT_REST, clear=behaviour, plan=True)
        held = RolloutState(motion.pose, *run.sent)
        if behaviour is Behaviour.BACK_OFF and run.retreat is not None:
            back = run.retreat.step(held, local, Pose2(0.0, 0.0, 0.0), None, self._driving)
            if not (back.ended or back.command.blocked or inputs.now - run.phase_since > 20.0):
                return NavigatorOutputs(command=back.command.velocity)
            run.retreat = None
            if back.ended:
                run.end_recovery(motion.pose, inputs.now)
                return NavigatorOutputs(command=AT_REST, plan=True, careful=True)
        move = move_to_recover(run.recovery, held, local, self._footprint, self._limits, self._settings.period)
        run.recovery = move.recovery
        if move.finished or inputs.now - run.phase_since > 20.0:
            run.end_recovery(motion.pose, inputs.now)
            return NavigatorOutputs(command=AT_REST, plan=True)
        return NavigatorOutputs(command=move.command)

    def _on_contact(self, run: GoalPursuit, contact: str, inputs: NavigatorInputs) -> NavigatorOutputs:
        """Back off from what stopped the robot, and plan around it; the third time, give up."""
        assert inputs.motion is not None
        run.contacts += 1
        place = inputs.odom.inverse().compose(inputs.motion.pose)
        text = f"something that the lidar does not see stopped the robot near ({place.x:.2f}, {place.y:.2f}): {contact}"
        if run.contacts >= _MOST_CONTACTS:
            return self._end(Ending.FAILED, f"{text}, for the {_MOST_CONTACTS}rd time")
        run.backing, run.legs, run.sent = Recovery(SEQUENCE.index(Behaviour.BACK_OFF)), None, AT_REST
        run.enter(NavigatorPhase.BACKING_OFF, inputs.now)
        return NavigatorOutputs(command=AT_REST, log=f"{text}; backing off")

    def _back_off(
        self, run: GoalPursuit, motion: RolloutState, local: LocalObstacles, inputs: NavigatorInputs
    ) -> NavigatorOutputs:
        held = RolloutState(motion.pose, *run.sent)
        move = move_to_recover(run.backing, held, local, self._footprint, self._limits, self._settings.period)
        run.backing = move.recovery
        if move.finished or inputs.now - run.phase_since > _BACKING[0]:
            run.enter(NavigatorPhase.PLANNING, inputs.now)
            return NavigatorOutputs(command=AT_REST, plan=True, careful=True)
        return NavigatorOutputs(command=move.command)

    def _get_stuck(self, run: GoalPursuit, inputs: NavigatorInputs, reason: str) -> NavigatorOutputs:
        pressed = run.waited_since is None and run.phase is not NavigatorPhase.PLANNING  # else it was at rest
        if run.contacts and inputs.beside and pressed:
            return self._on_contact(run, reason, inputs)
        if inputs.motion and inputs.local and not run.reason:  # there is a path, and it cannot be followed
            run.recovery = begin_recovery(run.recovery, inputs.motion, inputs.local, self._footprint, self._limits)
        behaviour = run.recovery.behaviour if self._settings.recovery_enabled else None
        if behaviour is None:
            tried = " (after clearing, turning and backing off)" if self._settings.recovery_enabled else ""
            return self._end(Ending.FAILED, f"{reason}{tried}")
        run.reason = reason
        run.recovery = Recovery(run.recovery.tried)
        run.retreat = None
        if behaviour is Behaviour.BACK_OFF and (self._limits.radius or is_long(self._footprint)):
            run.retreat = self._track.way_back(2.0 * self._footprint.circumscribed, self._limits)
        run.enter(NavigatorPhase.RECOVERING, inputs.now)
        return NavigatorOutputs(command=AT_REST, log=f"{reason}; recovering: {behaviour.value}")

    def _leads_to_people(self, run: GoalPursuit, odom: Pose2, local: LocalObstacles, points: int) -> bool:
        path = odom.transform_points(run.legs.rest[:points]) if run.legs else np.empty((0, 2))
        return leads_to_standing(path, local.people, self._footprint)

    @property
    def _driving(self) -> Driving:
        return Driving(self._footprint, self._limits, self._follow, self._settings.period)

    def _braked(self, run: GoalPursuit) -> DriveVelocity:
        return brake(run.sent, self._limits, self._settings.period)

    def _end(self, ending: Ending, text: str) -> NavigatorOutputs:
        self._run = None
        return NavigatorOutputs(command=AT_REST, ending=ending, text=text)
