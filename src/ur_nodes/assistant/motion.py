"""Motions of an assistant: begun by a call, and kept only while everything that the grant demands is true."""

import itertools
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from ur.mcp.grants import DriveGrant
from ur.source.diagnostic import UserError
from ur_nodes.assistant.messages import DriveCall, ExploreCall, GoCall
from ur_nodes.client.driver_text import describe_lost, name_holder
from ur_nodes.client.mux import MuxLink
from ur_nodes.client.navigation import NavigationTopics
from ur_nodes.client.snapshot import LastGoalState, heading_there
from ur_nodes.exploration.explorer import Explorer
from ur_nodes.exploration.explorer_step import ExplorerInputs, ExplorerOutputs, ExploreSettings, GoalEnd, read_settings
from ur_nodes.exploration.obstacles import Obstacles
from ur_nodes.exploration.status import ExploreStatus, describe_status
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.challenge.freshness import FRESHNESS
from ur_nodes.motion.challenge.link import ChallengeLink, stamped_name
from ur_nodes.motion.lease.text import Action, Lease, LeaseRequest, Terms, read_lease, write_request
from ur_nodes.motion.lease.view import Identity, LeaseView, view_lease
from ur_nodes.navigation.goals.goal_claim import write_any_heading, write_goal_id
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedTwist, Twist

_OUTSIDE = "outside of the area of the grant"

Allows = Callable[[Pose2], bool]


@dataclass(frozen=True, slots=True)
class NextPlace:
    """`pose`: drive there from now on; None: go on, or `cancel` the goal."""

    pose: Pose2 | None = None
    cancel: bool = False


class AssistedExploration:
    """Chooses places as `explore` does. Sends nothing: who drives asks for the next place, and reports its end."""

    def __init__(self, node: Node, settings: ExploreSettings) -> None:
        self._node, self._settings = node, settings
        self._explorer = Explorer(settings.explorer)
        self._grid: Grid | None = None
        self._version, self._due, self._busy = 0, 0.0, False
        self._end: GoalEnd | None = None
        self._next = NextPlace()
        self.status = ExploreStatus()
        """The newest status."""
        self._obstacles = Obstacles(node, settings.costmap, settings.costmap_updates)

    def begin(self) -> None:
        """Go on with what a call before has begun; anew where that has ended."""
        self._end, self._next = None, NextPlace()
        if self.status.ended:
            self._explorer, self.status = Explorer(self._settings.explorer), ExploreStatus()

    def note_end(self, reached: bool, text: str) -> None:
        """Take the end of the goal at the last place."""
        self._end = GoalEnd(reached, text)

    def choose_place(self, robot: Pose2, grid: Grid | None, allows: Allows) -> NextPlace:
        """The next place, once. One that is not allowed counts as not reached."""
        now = self._node.steady()
        if grid is not self._grid:
            self._grid, self._version = grid, self._version + 1
        found, self._next = self._next, NextPlace()
        if found.pose is not None and not allows(found.pose):
            found, self._end = NextPlace(cancel=True), GoalEnd(reached=False, text=_OUTSIDE)
        if self._grid is not None and not self._busy and (now >= self._due or self._end is not None):
            self._due, self._busy = now + self._settings.period, True
            seen = ExplorerInputs(now, self._grid, self._version, robot, self._obstacles.points(), self._end)
            self._end = None
            self._node.work(lambda: self._explorer.step(seen), self._on_outputs)
        return found

    def _on_outputs(self, out: ExplorerOutputs) -> None:
        self._busy, self.status = False, out.status
        self._next = NextPlace(out.goal, out.cancel)


_SOURCE = "key_vel"
_STILL = Twist(0.0, 0.0)
_PATIENCE = 2.0  # s: for the lease and the pose
_SILENCE = 1.0  # s without a beat after which the motion is given up; the robot is at rest long before
_POSE_AGE = 0.5  # s

MotionCall = DriveCall | GoCall | ExploreCall
Answer = Callable[[int, bool, str], None]
"""Takes the id of a call, whether it has succeeded, and a text."""


@dataclass(frozen=True, slots=True)
class HeldGrant:
    """A grant, and when it ends (s of the node's steady clock)."""

    grant: DriveGrant
    until: float


@dataclass(frozen=True, slots=True)
class AssistedMotion:
    """A motion that a call has begun at a time (s); `goal` is the number of the goal that was sent, 0 before."""

    call: MotionCall
    began: float
    driving_since: float | None = None
    goal: int = 0


class AssistedDriving:
    """At most one motion at a time. Works on the node's thread.

    Each beat of the assistant answers the challenge that was the newest when it was asked for a sign of life, within
    the grant, its time and its area, and with the lease on the grant's terms. Nothing else answers one. So the mux has
    the robot at rest 0.3 s after the last sign of life, whichever program drives it, and whichever hangs or ends.
    """

    def __init__(
        self,
        node: Node,
        mux: str,
        topics: NavigationTopics,
        stop: MuxLink,
        identity: Identity,
        answer: Answer,
        revoke: Callable[[str], None],
        pass_on: Callable[[int], None],
    ) -> None:
        """`revoke` is called with the reason when a person has taken over or stopped the robot: the grant has ended.

        `pass_on` is called with each challenge of the mux while a call drives.
        """
        self._node, self._topics, self._stop, self._identity = node, topics, stop, identity
        self._give, self._revoke, self._pass_on = answer, revoke, pass_on
        self.link = ChallengeLink(node, mux, self._on_challenge)
        self.lease: Lease | None = None
        self._held: HeldGrant | None = None
        self._motion: AssistedMotion | None = None
        self._exploration: AssistedExploration | None = None
        self._stopped = False  # by an emergency stop
        self._beat_at = -math.inf  # s
        self._passed: dict[int, float] = {}  # challenges that were passed on, and when (s)
        self._numbers = itertools.count(1)
        self._requests = node.publish(f"{mux}/lease_request", str, Quality.EVERY)
        self._velocities = node.publish(stamped_name(node, _SOURCE), StampedTwist, Quality.FRESH)
        node.subscribe(f"{mux}/lease", str, self._on_lease, Quality.LATCHED)
        node.every(0.1, self._check, steady=True)
        node.on_end(lambda: self.stop("the server has ended"))

    @property
    def grant(self) -> DriveGrant | None:
        """The grant that is in force."""
        held = self._held
        return held.grant if held is not None and self._node.steady() < held.until else None

    def set_grant(self, grant: DriveGrant | None) -> None:
        """Take a grant, or that there is none any more."""
        self._held = None if grant is None else HeldGrant(grant, self._node.steady() + grant.seconds)
        self._check()

    def beat(self, answer: int) -> None:
        """Take a sign of life of the assistant, which answers a challenge, and let it move the robot."""
        self._beat_at = self._node.steady()
        self._check()
        if self._motion is not None and self._beat_at - self._passed.get(answer, -math.inf) <= FRESHNESS:
            self._go_on(self._motion, answer)

    def begin(self, call: MotionCall) -> None:
        """Begin a motion, if it may begin now."""
        if self._motion is not None:
            self._give(call.id, False, "refused: another call drives the robot")
            return
        self._motion = AssistedMotion(call, self._node.steady())
        self._beat_at = self._node.steady()
        grant = self.grant
        if isinstance(call, GoCall) and grant is not None and not grant.allows(call.x, call.y):
            self._finish("refused: that place is outside of the area of the grant")
        elif isinstance(call, ExploreCall) and (problem := self._begin_exploration()):
            self._finish(f"refused: {problem}")
        else:
            self._check()

    def stop(self, why: str = "stopped") -> None:
        """End the motion."""
        if self._motion is not None:
            self._finish(why)

    def _on_challenge(self) -> None:
        """Pass a challenge on, so that the assistant's sign of life answers it: the mux then knows the age of that."""
        newest = self.link.newest()
        if self._motion is not None and newest is not None:
            now = self._node.steady()
            self._passed = {each: at for each, at in self._passed.items() if now - at <= FRESHNESS} | {newest: now}
            self._pass_on(newest)
        self._check()

    def _check(self) -> None:
        """End the motion where it may not go on, and the grant with a new emergency stop or a take-over."""
        motion, stopped = self._motion, self._stop.view().stopped is True
        if stopped and not self._stopped and self._held is not None:
            self._end_grant("an emergency stop")
        self._stopped = stopped
        if motion is None or self._motion is None:
            return
        view = view_lease(self.lease, self._identity.client, None, self.link.link_age())
        if view.other and motion.driving_since is not None:
            self._end_grant(f"{name_holder(view)} has taken over")
        elif why := self._find_hindrance(motion, view):
            self._finish(why)

    def _end_grant(self, reason: str) -> None:
        self._held = None
        self.stop(f"stopped: {reason}, and the grant has ended")
        self._revoke(reason)

    def _find_hindrance(self, motion: AssistedMotion, view: LeaseView) -> str:
        """The reason why a motion may not go on, '' for none."""
        now, grant = self._node.steady(), self.grant
        if grant is None:
            return "refused: no grant is in force; a person grants it, see the tool ask_to_drive"
        if self._stop.view().stopped:
            return "refused: the emergency stop is on, a person has to release it"
        if now - self._beat_at > _SILENCE:
            return "stopped: the assistant is silent"
        if view.state == "unknown" or view.out_of_reach:
            return "refused: no word from the robot's mux"
        if view.other or view.lost_by_other:
            return f"refused: {describe_lost(view) if view.lost_by_other else name_holder(view) + ' drives'}"
        pose = self._fresh_pose()
        if pose is None:
            waits = motion.driving_since is None and now - motion.began <= _PATIENCE
            return "" if waits else "refused: the pose of the robot is not known"
        if not grant.allows(pose.x, pose.y, *self._topics.robot.velocity()[:2]):
            return "stopped: the robot is at the border of the area of the grant"
        return self._find_delay(motion, now)

    def _fresh_pose(self) -> Pose2 | None:
        robot = self._topics.robot
        return robot.pose() if robot.age() <= _POSE_AGE else None

    def _find_delay(self, motion: AssistedMotion, now: float) -> str:
        if motion.driving_since is None:
            return "refused: the mux does not give the lease" if now - motion.began > _PATIENCE else ""
        late = now - motion.driving_since > motion.call.seconds
        if late and isinstance(motion.call, GoCall):
            return "stopped: not there within the time of the call; call again to go on"
        if late and isinstance(motion.call, ExploreCall) and self._exploration is not None:
            return f"stopped: call again to go on; {describe_status(self._exploration.status)}"
        return ""

    def _on_lease(self, text: str) -> None:
        lease = read_lease(text)
        if lease is not None:
            self.lease = lease
            self._check()

    def _go_on(self, motion: AssistedMotion, answer: int) -> None:
        grant = self.grant
        if grant is None or self._fresh_pose() is None:
            return
        lease, terms = self.lease, Terms(grant.speed, FRESHNESS)
        mine = lease is not None and lease.client == self._identity.client and lease.state == "held"
        self._request("renew" if mine else "acquire", answer, grant, terms)
        if not mine or lease is None or lease.terms != terms:
            return
        if motion.driving_since is None:
            motion = replace(motion, driving_since=self._node.steady())
            if isinstance(motion.call, GoCall):
                call = motion.call
                yaw = heading_there(self._topics.robot.pose(), call.x, call.y) if call.yaw is None else call.yaw
                goal = self._send_goal(Pose2(call.x, call.y, yaw), answer, any_heading=call.yaw is None)
                motion = replace(motion, goal=goal)
            self._motion = motion
        self._move(motion, answer)

    def _move(self, motion: AssistedMotion, answer: int) -> None:
        call, since = motion.call, motion.driving_since or 0.0
        if isinstance(call, DriveCall):
            if self._node.steady() - since >= call.seconds:
                self._finish("driven", done=True)
            else:
                self._velocities.send(
                    StampedTwist(answer, self._identity.client, Twist(call.forward, call.turn, call.left))
                )
            return
        goal = self._topics.goal()
        if motion.goal and goal.number != motion.goal:
            self._finish("stopped: another client has sent a goal")
        elif isinstance(call, ExploreCall):
            self._explore(motion, answer)
        elif goal.state is LastGoalState.REACHED:
            self._finish(f"reached{goal.text and f': {goal.text}'}", done=True)
        elif goal.over:
            self._finish(f"refused: {goal.text or goal.state.value}")

    def _begin_exploration(self) -> str:
        """Return why the robot cannot explore, '' where it can."""
        try:
            self._exploration = self._exploration or AssistedExploration(
                self._node, read_settings(self._node.parameters)
            )
        except UserError as problem:
            return str(problem)
        self._exploration.begin()
        return ""

    def _explore(self, motion: AssistedMotion, answer: int) -> None:
        """Report the end of the last goal, and drive to the next place."""
        exploration, grant, robot = self._exploration, self.grant, self._topics.robot.pose()
        if exploration is None or grant is None or robot is None:
            return
        if exploration.status.ended:
            self._finish(describe_status(exploration.status), done=True)
            return
        goal = self._topics.goal()
        if motion.goal and goal.over:
            exploration.note_end(goal.state is LastGoalState.REACHED, goal.text)
            motion = replace(motion, goal=0)
        found = exploration.choose_place(
            robot, self._topics.snapshot().grid, lambda place: grant.allows(place.x, place.y)
        )
        if found.pose is not None:
            motion = replace(motion, goal=self._send_goal(found.pose, answer, any_heading=False))
        elif found.cancel and motion.goal:
            self._topics.cancel_goals()
        self._motion = motion

    def _send_goal(self, pose: Pose2, answer: int, *, any_heading: bool) -> int:
        start = f"{self._node.name}-{next(self._numbers)}-{time.time():.3f}"
        start = write_any_heading(start) if any_heading else start
        return self._topics.send_goal(write_goal_id(start, self._identity.client, answer), pose)

    def _request(
        self, action: Action, answer: int, grant: DriveGrant | None, terms: Terms | None, note: str = ""
    ) -> None:
        who = self._identity
        program = grant.text if grant is not None else who.program
        stamp = divmod(answer, SECOND)
        request = LeaseRequest(who.client, who.name, program, action, True, stamp, who.computer, terms, note)
        self._requests.send(write_request(request))

    def _finish(self, text: str, *, done: bool = False) -> None:
        """Stop what the motion has begun, hand the lease back, and answer the call."""
        motion, self._motion = self._motion, None
        if motion is None:
            return
        newest = self.link.newest()
        mine = self.lease is not None and self.lease.client == self._identity.client
        if motion.goal and self._topics.goal().number == motion.goal and not self._topics.goal().over:
            self._topics.cancel_goals()
        if newest is not None and mine and isinstance(motion.call, DriveCall):
            self._velocities.send(StampedTwist(newest, self._identity.client, _STILL))
        if newest is not None:
            self._request("release", newest, self.grant, None, "" if done else f"assistant: {text}")
        self._give(motion.call.id, done, text)
