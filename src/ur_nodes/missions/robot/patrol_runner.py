"""The patrol's connection to topics: requests, the lease, the emergency stop, its goals and its status."""

import itertools
from dataclasses import dataclass
from functools import partial

from ur.source.foreign.json_values import BadJsonError
from ur_nodes.client.goal_tracker import GoalTracker, is_unconfirmed, report_at, track_result, track_sent, track_status
from ur_nodes.client.patrol_text import (
    PatrolAnswer,
    PatrolRequest,
    PatrolRoute,
    PatrolStatus,
    PatrolStop,
    describe_patrol,
    read_request,
    write_status,
)
from ur_nodes.client.snapshot import GoalReport, LastGoalState, heading_there
from ur_nodes.geometry.pose import Pose2
from ur_nodes.missions.robot.patrol import (
    NavigationCommands,
    Patrol,
    PatrolInputs,
    PlaceLookup,
    answer_request,
    end_patrol,
    pause_patrol,
    resume_patrol,
    start_patrol,
    step_patrol,
)
from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.motion.lease.text import Lease, read_lease
from ur_nodes.motion.lease.view import Identity
from ur_nodes.navigation.goals.attendance import LATEST, clock_time, name_of_driver
from ur_nodes.navigation.goals.goal_claim import (
    REMEMBERED,
    ReceivedChallenges,
    age_of_answer,
    lag_of_answer,
    note_challenge,
    write_any_heading,
    write_goal_id,
)
from ur_nodes.ports import actions
from ur_nodes.ports.node import Node, Sender
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedPose


class PatrolGoal:
    """Sends goals, one at a time. Goals of an earlier node of this name are cancelled."""

    def __init__(self, node: Node, navigation: str, frames: tuple[str, str], client: LeaseClient) -> None:
        """`frames` are those of the map and of the base; `client` is the sender that the goals name."""
        self._node, self._client = node, client
        self._map_frame, self._base_frame = frames
        self._transforms = node.transforms
        self._tracker = GoalTracker()
        self._goal = ""
        self._numbers = itertools.count(1)
        self._prefix = f"{node.name}-patrol-"
        self._goals = node.follow_goals(navigation, self)

    @property
    def report(self) -> GoalReport | None:
        """Return the state of the goal; None without a goal, or before navigation has reported it."""
        report = report_at(self._tracker, self._node.steady())
        mentioned = self._goal and (self._tracker.known or report.state is LastGoalState.FAILED)
        return report if mentioned else None

    @property
    def ready(self) -> bool:
        """Return whether a goal can be sent now."""
        answers = self._client.view().state == "unknown" or self._answer() is not None
        return answers and self._goals.servers() > 0

    def send(self, stop: PatrolStop) -> None:
        """Drive to a stop whose place is known."""
        assert stop.x is not None, "looked up before the start"
        start = f"{self._prefix}{next(self._numbers)}-{self._node.now()}"
        start = write_any_heading(start) if stop.yaw is None else start
        answer = self._answer()
        claimed = answer is not None and self._client.view().state != "unknown"
        self._goal = write_goal_id(start, self._client.client, answer) if claimed and answer is not None else start
        yaw = stop.yaw
        if yaw is None:
            yaw = heading_there(self._transforms.find_planar(self._map_frame, self._base_frame), stop.x, stop.y)
        place = Pose2(stop.x, stop.y, yaw)
        self._tracker = track_sent(self._tracker, self._goal, place, self._node.steady())
        self._sent = actions.Goal(self._goal, StampedPose(self._node.now(), self._map_frame, place))
        self._goals.send(self._sent)

    def cancel(self) -> None:
        """Cancel the goal."""
        if self._goal:
            self._goals.cancel(self._goal)
            self._goal = ""

    def on_states(self, states: tuple[actions.GoalState, ...]) -> None:
        if self._goal:
            now = self._node.steady()
            self._tracker = track_status(self._tracker, states, now)
            if is_unconfirmed(self._tracker, now):
                self._goals.send(self._sent)
        for each in states:  # of a node of this name that was killed
            if each.open and each.id.startswith(self._prefix) and each.id != self._goal:
                self._goals.cancel(each.id)

    def on_goal_end(self, state: actions.GoalState) -> None:
        if self._goal:
            self._tracker = track_result(self._tracker, state, self._node.steady())

    def _answer(self) -> int | None:
        return self._client.link.newest(REQUEST_FRESHNESS / 2.0)


_NANO = 1_000_000_000


def refuse_request(
    request: PatrolRequest, lease: Lease | None, own: str, challenges: ReceivedChallenges, now: float, *, latched: bool
) -> str:
    """Return the reason why a request is refused; '' when it is accepted.

    `own` is the patrol's client of the lease, which is None where the mux has none. `latched`: the publisher keeps the
    message for subscribers that come later, so nothing shows its age. To pause and to end is never refused.
    """
    if request.action in ("pause", "end"):
        return ""
    if lease is not None and lease.client not in ("", own) and lease.client != (request.client or None):
        if lease.state == "held":
            return f"{name_of_driver(lease)} drives since {clock_time(lease.since)}"
        return f"{name_of_driver(lease)} drove and is out of reach, take over first"
    if request.answers is None:
        return "a latched request may be old; publish it without latching, or with a challenge" if latched else ""
    answer = request.answers[0] * _NANO + request.answers[1]
    age = age_of_answer(challenges, answer, now)
    if age is not None and age <= LATEST:
        return ""
    lag = age if age is not None else lag_of_answer(challenges, answer, now)
    return f"the request arrived late{'' if lag is None else f' ({lag:.1f} s)'}, send it again"


_PERIOD = 0.1  # s


@dataclass(frozen=True, slots=True)
class PatrolSettings:
    """`mux` and `navigation` are nodes; `keeper` is the one whose parameters lead to the file of waypoints.

    `step_limit` (s): so long may the way to a place take.
    """

    mux: str
    navigation: str
    map_frame: str
    base_frame: str
    keeper: str
    step_limit: float


class PatrolRunner:
    """Connects the state machine to the topics of the node."""

    def __init__(self, node: Node, settings: PatrolSettings) -> None:
        self._node, self._settings = node, settings
        self._patrol = Patrol()
        self._shown: PatrolStatus | None = None
        self._line = ""
        self._lease: Lease | None = None
        self._challenges = ReceivedChallenges()
        self._stopped = False
        identity = Identity(("patrol" + node.name.replace("/", "."))[:64], "patrol", "")
        mux, frames = settings.mux, (settings.map_frame, settings.base_frame)
        self._client = LeaseClient(node, mux, conduct="watch", identity=identity, on_challenge=self._on_challenge)
        self._goal = PatrolGoal(node, settings.navigation, frames, self._client)
        self._places = PlaceLookup(node, settings.keeper)
        self._status = node.publish("~status", str, Quality.LATCHED)
        self._publish()
        node.subscribe(f"{mux}/lease", str, self._on_lease, Quality.LATCHED)
        node.subscribe(f"{mux}/stopped", bool, self._on_stopped, Quality.LATCHED)
        node.subscribe_from("~request", str, self._on_request, Quality.EVERY)
        node.every(_PERIOD, self._step, steady=True)
        node.on_end(self._end)

    def _step(self) -> None:
        self._patrol, commands = step_patrol(self._patrol, self._look(), self._settings.step_limit)
        self._obey(commands)
        if not self._patrol.status.active and self._client.view().mine:
            self._client.release(final=False)

    def _look(self) -> PatrolInputs:
        view, taken, report = self._client.view(), self._client.taken_over, self._goal.report
        other = view.holder or (name_of_driver(taken) if taken else "")  # who took over may have let go since
        return PatrolInputs(
            self._node.steady(),
            may_drive=view.state == "unknown" or (view.mine and view.state == "held"),
            ready=self._goal.ready,
            other="" if view.mine else other,
            stopped=self._stopped,
            goal=report.state if report else None,
            text=report.text if report else "",
        )

    def _obey(self, commands: NavigationCommands) -> None:
        if commands.cancel:
            self._goal.cancel()
        if commands.send is not None:
            self._goal.send(commands.send)
        self._publish()

    def _publish(self) -> None:
        status = self._patrol.status
        if status == self._shown:
            return
        self._shown = status
        self._status.send(write_status(status))
        line = describe_patrol(status)
        if line and line != self._line:
            self._node.log.info(line)
        self._line = line

    def _on_request(self, text: str, sender: Sender | None) -> None:
        try:
            request = read_request(text)
        except BadJsonError as problem:
            self._node.log.warn(f"a request for a patrol is ignored, {problem}")
            return
        latched = sender is not None and sender.kept
        self._places.find(request.route, partial(self._on_route, request, latched=latched))

    def _on_route(self, request: PatrolRequest, route: PatrolRoute | str, *, latched: bool) -> None:
        problem = route if isinstance(route, str) else self._admit(request, route, latched=latched)
        if problem:
            self._node.log.warn(f"{request.action} refused: {problem}")
        self._patrol = answer_request(self._patrol, PatrolAnswer(request.id, problem[:300]))
        self._publish()

    def _admit(self, request: PatrolRequest, route: PatrolRoute, *, latched: bool) -> str:
        """Accept a request, or return the reason why it is refused."""
        now, own = self._node.steady(), self._client.client
        refusal = refuse_request(request, self._lease, own, self._challenges, now, latched=latched)
        if not refusal and request.action in ("start", "resume") and self._stopped:
            refusal = "the emergency stop is on, release it first"
        return refusal or self._accept(request, route, now)

    def _accept(self, request: PatrolRequest, route: PatrolRoute, now: float) -> str:
        patrol, commands = self._patrol, NavigationCommands()
        if request.action == "start":
            patrol, commands = start_patrol(patrol, route, now), NavigationCommands(cancel=True)
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
            (self._client.take_over if handed else self._client.acquire)()
        self._patrol = patrol
        self._obey(commands)
        return ""

    def _on_challenge(self) -> None:
        value = self._client.link.newest(REMEMBERED)
        if value is not None:
            self._challenges = note_challenge(self._challenges, value, self._node.steady())

    def _on_lease(self, text: str) -> None:
        self._lease = read_lease(text) or self._lease

    def _on_stopped(self, stopped: bool) -> None:
        self._stopped = stopped

    def _end(self) -> None:
        self._goal.cancel()
        self._client.release()
