"""Goals and pose estimates that pages send to navigation."""

import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from ur.web.wire.requests import GoalRequest, GoTo, InitialPose
from ur_nodes.client.navigation import NavigationTopics
from ur_nodes.client.snapshot import heading_there
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.challenge.freshness import Stamp
from ur_nodes.navigation.goals.goal_claim import write_any_heading, write_goal_id
from ur_nodes.ports.node import Node
from ur_nodes.web.driving.driver_link import DriverLink, number_of
from ur_nodes.web.driving.page_lease import PageLease, StickState, may_drive, note_end, request_action

Refuse = Callable[[str, str], None]
"""Refuses a request, by its name, for a reason."""

_WHAT = {GoalRequest: "goal", GoTo: "go_to", InitialPose: "pose"}


@dataclass(frozen=True, slots=True)
class GoalPage:
    """A page that may drive; one that is `once` cannot reconnect; `goal` is the number of its last goal.

    The number is 0 where it has sent none, or its end is known.
    """

    name: str
    lease: PageLease
    stick: StickState = field(default_factory=StickState)
    once: bool = False
    goal: int = 0


class PageGoals:
    """Passes goals and poses to navigation. Refuses requests that are late, or of pages that may not drive."""

    def __init__(
        self, node: Node, topics: NavigationTopics, link: DriverLink, find_place: Callable[[str], Pose2 | None]
    ) -> None:
        self._node, self._topics, self._link, self._find_place = node, topics, link, find_place
        self._numbers = itertools.count(1)

    def cancel(self) -> None:
        """Cancel the goal of any client."""
        self._topics.cancel_goals()

    def note(self, page: GoalPage) -> GoalPage:
        """Check whether the goal of a page has ended, and note it."""
        goal = self._topics.goal()
        if page.goal and (goal.number != page.goal or goal.over):
            return replace(page, goal=0, lease=note_end(page.lease, self._node.steady()))
        return page

    def apply(self, page: GoalPage, request: GoalRequest | GoTo | InitialPose, refuse: Refuse) -> GoalPage:
        """Carry out a request of a page. If it is refused, the lease is released unless its page drives to a goal."""
        why = ""
        if isinstance(request, GoTo):
            place = self._find_place(request.place)
            if place is None:
                why = "no place"
            else:
                return self.apply(page, GoalRequest(request.answers, *place), refuse)
        elif self._link.is_late(request.answers):
            why = "late"
        elif not may_drive(page.lease, self._link.lease):
            why = "driver"
        if why:
            refuse(_WHAT[type(request)], why)
            return page if page.goal else replace(page, lease=note_end(page.lease, self._node.steady()))
        if isinstance(request, InitialPose):
            self._topics.set_pose(Pose2(request.x, request.y, request.yaw))
        elif isinstance(request, GoalRequest):
            return self._go(page, request)
        return page

    def _go(self, page: GoalPage, goal: GoalRequest) -> GoalPage:
        goal_id, yaw = f"{self._node.name}-{next(self._numbers)}-{time.time():.3f}", goal.yaw
        if yaw is None:
            goal_id = write_any_heading(goal_id)
            yaw = heading_there(self._topics.robot.pose(), goal.x, goal.y)
        if self._link.lease is not None:
            page = self.acquire(page, goal.answers)
            goal_id = write_goal_id(goal_id, page.lease.client, number_of(goal.answers))
        number = self._topics.send_goal(goal_id, Pose2(goal.x, goal.y, yaw))
        return replace(page, goal=number, lease=replace(page.lease, ended_at=None))

    def acquire(self, page: GoalPage, answer: Stamp) -> GoalPage:
        """Request the lease for a page that begins to drive, unless it has it."""
        lease = self._link.lease
        if lease is None or lease.client == page.lease.client:
            return page
        page = replace(page, lease=request_action(page.lease, "acquire", self._node.steady()))
        self._link.request(page.lease, page.name, "acquire", answer)
        return page
