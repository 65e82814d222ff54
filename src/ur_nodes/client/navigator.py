"""A `Navigator`: the topics of navigation, the mux, the patrol, and this program's lease."""

import itertools
import math
import time
from collections.abc import Callable
from dataclasses import replace

from ur.source.diagnostic import user_error
from ur_nodes.client.driver_text import DriverRequest, describe_silence
from ur_nodes.client.mux import MuxLink, MuxRequest
from ur_nodes.client.navigation import Names, NavigationTopics, Wait, call_and_wait, wait_in_real_time
from ur_nodes.client.patrol_text import PatrolAction, PatrolLink, PatrolRequest, PatrolRoute
from ur_nodes.client.snapshot import ROBOT, GoalReport, LastGoalState, RobotSnapshot, Silence
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.motion.lease.view import LeaseView
from ur_nodes.navigation.goals.goal_claim import write_any_heading, write_goal_id
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.services import Silent

_DISCOVERY = 5.0  # s after which a graph without the lease of a mux is believed: on ROS 2 nodes find each other late
_SILENT = 1.0  # s without a message, after which a sender counts as silent


class RobotNavigator:
    """See `Navigator`. Made before the node's callbacks begin; then used by one other thread.

    Missing data is listed in `RobotSnapshot.missing`. The lease is released at the end of the node.
    """

    def __init__(
        self,
        node: Node,
        names: Names,
        program: str,
        wait: Wait = wait_in_real_time,
        on_challenge: Callable[[], None] | None = None,
        hangs: Callable[[], bool] = lambda: False,
    ) -> None:
        """`program` is shown to other users as the one that drives; for `hangs` see LeaseClient."""
        self._node, self._wait = node, wait
        self._numbers = itertools.count(1)
        self._sent = GoalReport()
        self._on_its_way = False  # from here to the node's thread
        self.mux = MuxLink(node, names.mux)
        self.lease = LeaseClient(node, names.mux, program, on_challenge=on_challenge, hangs=hangs)
        self.topics = NavigationTopics(node, names)
        self._patrol = PatrolLink(node)
        self._lease_topic = node.resolve(f"{names.mux}/lease")
        self._leased = True  # until it is known
        node.after(_DISCOVERY, lambda: node.read_graph(self._note_graph), steady=True)
        node.on_end(self.lease.release)

    def snapshot(self) -> RobotSnapshot:
        """Return the newest state."""
        sent = self._sent if self._on_its_way else None  # read before what it replaces
        seen, mux, lease = self.topics.snapshot(), self.mux.view(), self.lease.view()
        missing = seen.missing
        if lease.state == "unknown" and (mux.stopped is not None or self._leased):
            # A mux of ours has to publish its lease before the first goal.
            missing = (*missing, f"the lease of the mux (topic {self._lease_topic})")
        if sent is not None:
            seen = replace(seen, goal=sent, path=None)
        return replace(
            seen,
            missing=missing,
            mux=mux,
            lease=lease,
            conduct=self.lease.conduct,
            silence=self._silence(lease),
            patrol=self._patrol.status(),
        )

    def go(self, pose: Pose2, *, any_heading: bool = False) -> int:
        """See `Navigator`. The goal's id names the client that sends it and answers the mux's newest challenge."""
        goal_id = self._make_goal_id(any_heading=any_heading)
        number = max(self._sent.number, self.topics.goal().number) + 1
        self._sent = GoalReport(number, pose, LastGoalState.WAITING, any_heading=any_heading)
        self._on_its_way = True
        self._node.post(lambda: self._send(goal_id, pose, number))
        return number

    def request_lease(self, request: DriverRequest) -> None:
        """Request the lease, or release it."""
        self._node.post(lambda: self.lease.request(request))

    def ask_patrol(self, action: PatrolAction, route: PatrolRoute) -> str:
        """See `Navigator`. A request that sets the robot in motion answers the mux's newest challenge."""
        answer, who = self.lease.link.newest(REQUEST_FRESHNESS / 2.0), self.lease.identity
        request = PatrolRequest(
            action,
            route,
            f"{who.client[:40]}-{next(self._numbers)}",
            who.client if answer else "",
            who.name,
            divmod(answer, SECOND) if answer else None,
        )
        if not self._patrol.served():
            expected = "expected a robot that runs it ('ur run keyboard_navigate' does)"
            raise user_error(f"no node drives patrols, {expected}", rule="no-patrol")
        self._node.post(lambda: self._ask_patrol(request))
        return request.id

    def stop(self) -> None:
        """Cancel the goal of any client."""
        self._node.post(self.topics.cancel_goals)

    def ask_mux(self, request: MuxRequest) -> None:
        """Request an emergency stop or its release."""
        self.mux.ask(request)

    def set_pose(self, pose: Pose2) -> None:
        """Set the estimated pose of the robot."""
        self._node.post(lambda: self.topics.set_pose(pose))

    def relocalise(self) -> None:
        """Search for the robot on the whole map. Raises UserError when the localiser does not offer that."""
        result = call_and_wait(self._node, self._wait, "global_localization", Silent())
        if not result.success:
            name = self._node.resolve("global_localization")
            raise user_error(f"service {name}: {result.text}, expected a localiser that offers it", rule="no-service")

    def _note_graph(self, graph: Graph | None) -> None:
        topic = graph.topics.get(self._lease_topic) if graph else None
        self._leased = bool(topic and topic.publishers)

    def _make_goal_id(self, *, any_heading: bool) -> str:
        start = f"{self._node.name}-{next(self._numbers)}-{time.time():.3f}"
        start = write_any_heading(start) if any_heading else start
        view = self.lease.view()
        if view.state == "unknown":
            return start  # a mux without leases, as upstream's
        answer = self.lease.link.newest(REQUEST_FRESHNESS / 2.0)
        if answer is None:
            raise user_error(describe_silence(ROBOT, view.link_age), rule="no-word")
        return write_goal_id(start, self.lease.client, answer)

    def _send(self, goal_id: str, pose: Pose2, number: int) -> None:
        view = self.lease.view()
        if view.state != "unknown" and not view.mine:
            self.lease.acquire()
        self.topics.send_goal(goal_id, pose, number)
        if number == self._sent.number:
            self._on_its_way = False

    def _ask_patrol(self, request: PatrolRequest) -> None:
        self._patrol.request(request)

    def _silence(self, lease: LeaseView) -> Silence | None:
        """Return the sender that was received before and is silent now: the robot when mux and navigation both are."""
        received = [] if lease.state == "unknown" else [("the mux", lease.link_age)]
        status_age = self.topics.status_age()
        if status_age < math.inf:
            received.append(("navigation", status_age))
        silent = [Silence(*each) for each in received if each[1] > _SILENT]
        if not silent:
            return None
        if len(silent) == len(received):
            return Silence(ROBOT, min(each.seconds for each in silent))
        return silent[0]
