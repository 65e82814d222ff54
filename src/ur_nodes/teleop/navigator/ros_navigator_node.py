"""A `Navigator` over ROS: the topics of navigation, and this program's part in the lease of the mux."""

from __future__ import annotations

import itertools
import time
from dataclasses import replace

import rospy
from std_srvs.srv import Empty

from ur.source.diagnostic import UserError, error
from ur_nodes.client.driver_text import DriverRequest, describe_silence
from ur_nodes.client.model import ROBOT, Silence, Snapshot
from ur_nodes.client.mux import MuxRequest
from ur_nodes.client.patrol_text import PatrolAction, PatrolRequest, Route
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS
from ur_nodes.motion.lease.client_node import LeaseClient
from ur_nodes.motion.lease.view import LeaseView
from ur_nodes.navigation.goals.goal_claim import write_any_heading, write_goal_id
from ur_nodes.teleop.navigator.mux_link_node import MuxLink
from ur_nodes.teleop.navigator.navigation_topics_node import Names, NavigationTopics
from ur_nodes.teleop.navigator.patrol_link_node import PatrolLink

_SILENT = 1.0  # s without a message, after which a sender counts as silent
_NANO = 1_000_000_000


class RosNavigator:
    """See `Navigator`. The node is registered before one is made; what has not come yet is in `Snapshot.missing`."""

    def __init__(self, names: Names) -> None:
        self._numbers = itertools.count(1)
        self._mux = MuxLink(names.mux)
        self._lease = LeaseClient(names.mux, "keyboard_navigate")
        self._lease_topic = rospy.resolve_name(f"{names.mux}/lease")
        self._leased = any(topic == self._lease_topic for topic, _ in rospy.get_published_topics())
        self._topics = NavigationTopics(names)
        self._patrol = PatrolLink()

    def snapshot(self) -> Snapshot:
        """Return the newest state."""
        now, mux, lease = time.monotonic(), self._mux.view(), self._lease.view()
        seen = self._topics.snapshot(now)
        missing = seen.missing
        if lease.state == "unknown" and (mux.stopped is not None or self._leased):
            # A mux of ours has to publish its lease before the first goal.
            missing = (*missing, f"the lease of the mux (topic {self._lease_topic})")
        silence = self._silence(lease, now)
        return replace(
            seen,
            missing=missing,
            mux=mux,
            lease=lease,
            conduct=self._lease.conduct,
            silence=silence,
            patrol=self._patrol.status(),
        )

    def go(self, place: Pose2, *, any_heading: bool = False) -> int:
        """See `Navigator`. The goal's id names the client that sends it and answers the mux's newest challenge."""
        return self._topics.send_goal(self._make_goal_id(any_heading=any_heading), place)

    def _make_goal_id(self, *, any_heading: bool) -> str:
        start = f"{rospy.get_name()}-{next(self._numbers)}-{time.time():.3f}"
        start = write_any_heading(start) if any_heading else start
        view = self._lease.view()
        if view.state == "unknown":
            return start  # a mux without leases, as upstream's
        answer = self._lease.link.answer(REQUEST_FRESHNESS / 2.0)
        if answer is None:
            raise UserError(error(describe_silence(ROBOT, view.link_age), rule="no-word"))
        if not view.mine:
            self._lease.acquire()
        return write_goal_id(start, self._lease.client, answer.secs * _NANO + answer.nsecs)

    def resume(self) -> None:
        """Let the goal that is held go on, if this arrives in time."""
        answer = self._lease.link.answer(REQUEST_FRESHNESS / 2.0)
        if answer is not None:
            self._topics.continue_goal(answer)

    def request_lease(self, request: DriverRequest) -> None:
        """Ask to drive, or let another drive."""
        {"take": self._lease.take, "ask": self._lease.ask, "grant": self._lease.grant}[request]()

    def ask_patrol(self, action: PatrolAction, route: Route) -> str:
        """See `Navigator`. A request that sets the robot in motion answers the mux's newest challenge."""
        answer = self._lease.link.answer(REQUEST_FRESHNESS / 2.0)
        who = self._lease.identity
        request = PatrolRequest(
            action,
            route,
            f"{who.client[:40]}-{next(self._numbers)}",
            who.client if answer else "",
            who.name,
            (answer.secs, answer.nsecs) if answer else None,
        )
        if not self._patrol.request(request):
            expected = "expected a robot that runs it ('ur run keyboard_navigate' does)"
            raise UserError(error(f"no node drives patrols, {expected}", rule="no-patrol"))
        return request.id

    def close(self) -> None:
        """Release the lease."""
        self._lease.release()

    def stop(self) -> None:
        """Cancel the goal, whoever sent it."""
        self._topics.cancel_goals()

    def ask_mux(self, request: MuxRequest) -> None:
        """Stop everything that drives, or release the emergency stop."""
        self._mux.ask(request)

    def set_pose(self, place: Pose2) -> None:
        """Set the estimated pose of the robot."""
        self._topics.set_pose(place)

    def relocalise(self) -> None:
        """Search for the robot on the whole map. Raises UserError when the localiser does not offer that."""
        try:
            rospy.ServiceProxy("global_localization", Empty)()
        except (rospy.ServiceException, rospy.ROSException) as problem:
            name = rospy.resolve_name("global_localization")
            raise UserError(
                error(f"service {name}: {problem}, expected a localiser that offers it", rule="no-service")
            ) from None

    def _silence(self, lease: LeaseView, now: float) -> Silence | None:
        """Return the sender that was received before and is silent now: the robot when mux and navigation both are."""
        heard = [] if lease.state == "unknown" else [("the mux", lease.link_age)]
        status_age = self._topics.status_age(now)
        if status_age < float("inf"):
            heard.append(("navigation", status_age))
        silent = [Silence(*each) for each in heard if each[1] > _SILENT]
        if not silent:
            return None
        if len(silent) == len(heard):
            return Silence(ROBOT, min(each.seconds for each in silent))
        return silent[0]
