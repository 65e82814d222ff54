"""Requests of pages that drive: each is checked, answered, and passed on to the mux and to navigation."""

from __future__ import annotations

import itertools
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import rospy
from geometry_msgs.msg import Twist, TwistStamped, Vector3
from std_msgs.msg import Float32, String, Time

from ur.web.wire.map_requests import MapRequest
from ur.web.wire.reading import BadRequestError
from ur.web.wire.requests import (
    Alive,
    AskForLease,
    AskPatrol,
    Cancel,
    Emergency,
    Goal,
    GoTo,
    InitialPose,
    LetGo,
    LimitSpeed,
    Request,
    Resume,
    Stick,
    SwitchObstacleStop,
    read_request,
)
from ur_nodes.client.model import heading_there
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS, Stamp
from ur_nodes.motion.clock import read_steady_time
from ur_nodes.motion.lease.text import Action, Lease, clean_computer, clean_name, is_client, read_lease, write_request
from ur_nodes.motion.lease.text import Request as LeaseRequest
from ur_nodes.navigation.goals.goal_claim import write_any_heading, write_goal_id
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.teleop.navigator.mux_link_node import MuxLink
from ur_nodes.teleop.navigator.navigation_topics_node import NavigationTopics
from ur_nodes.teleop.navigator.patrol_link_node import PatrolLink
from ur_nodes.web.heard import Heard, age_of_answer, hear
from ur_nodes.web.map_changes_node import MapChanges, Reply
from ur_nodes.web.page_lease import PageLease, may_drive, note_end, request_action, step_page, takes_part
from ur_nodes.web.patrol_requests_node import ask_patrol
from ur_nodes.web.places import Places
from ur_nodes.web.stick import StickState, Verdict, end_stick, expire_stick, let_go, step_stick

VELOCITIES = "web_vel_stamped"
_PROGRAM = "web"
_NANO = 1_000_000_000
_MOST_PAGES = 100


@dataclass(frozen=True, slots=True)
class _Page:
    name: str
    lease: PageLease
    stick: StickState = field(default_factory=StickState)
    once: bool = False  # it cannot come again
    goal: int = 0  # the number of its last goal; 0: it has sent none, or its end is known


class DriveEnd:
    """Pages that may drive, by client id. `reply` sends an answer to one of them; it is called with a lock held.

    Methods may be called from any thread. `limits` are the highest velocities that are passed on, m/s and rad/s.
    """

    def __init__(
        self,
        mux: str,
        topics: NavigationTopics,
        link: MuxLink,
        places: Places,
        patrol: PatrolLink,
        changes: MapChanges,
        limits: tuple[float, float],
        reply: Reply,
        announce: Callable[[Stamp], None],
    ) -> None:
        """`announce` passes a challenge on to all pages."""
        self._topics, self._link, self._places, self._limits = topics, link, places, limits
        self._reply, self._announce, self._patrol, self._changes = reply, announce, patrol, changes
        self._lock = threading.RLock()
        self._heard = Heard()
        self._heard_at = float("-inf")
        self._lease: Lease | None = None
        self._pages: dict[str, _Page] = {}
        self._numbers = itertools.count(1)
        self._velocities = rospy.Publisher(VELOCITIES, TwistStamped, queue_size=1, tcp_nodelay=True)
        self._speed_limit = rospy.Publisher(f"{mux}/speed_limit", Float32, queue_size=1)
        self._requests = rospy.Publisher(f"{mux}/lease_request", String, queue_size=5, tcp_nodelay=True)
        rospy.Subscriber(f"{mux}/lease", String, self._on_lease, queue_size=1, tcp_nodelay=True)
        rospy.Subscriber(f"{mux}/challenge", Time, self._on_challenge, queue_size=1, tcp_nodelay=True)

    def lease(self) -> Lease | None:
        """Return the lease; None before the mux has sent one."""
        with self._lock:
            return self._lease

    def link_age(self) -> float:
        """Return the seconds since the mux's last challenge; infinite before the first."""
        with self._lock:
            return read_steady_time() - self._heard_at

    def come(self, client: str, name: str, computer: str, *, once: bool = False) -> None:
        """A page that may drive is there; `computer` identifies its browser, `once`: it cannot come again."""
        if not is_client(client):
            return
        with self._lock:
            lease = PageLease(client, clean_computer(computer))
            self._pages[client] = _Page(clean_name(name) or "a page", lease, once=once)
            while len(self._pages) > _MOST_PAGES:
                self.leave(next(iter(self._pages)))

    def rename(self, client: str, name: str) -> None:
        """A page has another name from its next request on."""
        with self._lock:
            if client in self._pages:
                self._pages[client] = replace(self._pages[client], name=clean_name(name) or "a page")

    def leave(self, client: str) -> None:
        """A page is gone: what its user held is over at once.

        Its goal is held when the mux has lost it. One that cannot come again leaves no goal and no lease behind.
        """
        with self._lock:
            page = self._pages.pop(client, None)
            if page is not None:
                _, verdict = end_stick(page.stick)
                self._finish(page, verdict, "")
                if page.once:
                    self._give_up(page)

    def _give_up(self, page: _Page) -> None:
        """Cancel the goal of a client and release its lease, or withdraw its request for it."""
        if self._lease is None or self._heard.newest is None:
            return
        if self._lease.client == page.lease.client:
            self._topics.cancel_goals()
        if takes_part(page.lease, self._lease):
            self._request(page, "release", self._heard.newest)

    def leave_all(self) -> None:
        """The server is gone."""
        with self._lock:
            for client in list(self._pages):
                self.leave(client)

    def expire(self) -> None:
        """End presses whose commands stay away; to be called often."""
        with self._lock:
            now = read_steady_time()
            for client, page in list(self._pages.items()):
                if page.stick.live:
                    self._step(client, page, expire_stick(page.stick, now), "late")

    def emergency(self) -> None:
        """Stop everything that drives, whoever asks."""
        self._link.ask("stop")

    def take(self, client: str, text: str) -> None:
        """Take a request of a page."""
        try:
            request = read_request(text)
        except BadRequestError as problem:
            self._reply(client, {"t": "bad", "why": str(problem)})
            return
        if isinstance(request, MapRequest):
            if client in self._pages:
                self._changes.take(client, request)
            return
        with self._lock:
            page = self._pages.get(client)
            if page is None:
                return
            if isinstance(request, AskPatrol):
                self._ask_patrol(client, page, request)
            else:
                self._obey(client, page, request)

    def _obey(self, client: str, page: _Page, request: Request) -> None:
        now = read_steady_time()
        if isinstance(request, Stick):
            self._drive(client, page, request, now)
        elif isinstance(request, LetGo):
            self._step(client, page, let_go(page.stick, request.hold), "")
        elif isinstance(request, Alive):
            self._renew(client, page, request.answers, now)
        elif isinstance(request, AskForLease):
            self._ask_for_lease(client, page, request, now)
        elif isinstance(request, Emergency):
            self._link.ask("stop" if request.stop else "release")
        elif isinstance(request, LimitSpeed):
            self._speed_limit.publish(float(request.percent))
        elif isinstance(request, SwitchObstacleStop):
            self._link.ask("obstacles on" if request.on else "obstacles off")
        elif isinstance(request, Cancel):
            self._topics.cancel_goals()
        elif isinstance(request, GoTo):
            place = self._places.find(request.place)
            if place is None:
                self._refuse(client, page, "go_to", "no place", now)
            else:
                self._navigate(client, page, Goal(request.answers, *place), now)
        elif not isinstance(request, MapRequest | AskPatrol):
            self._navigate(client, page, request, now)

    def _ask_for_lease(self, client: str, page: _Page, request: AskForLease, now: float) -> None:
        if request.action == "release" and page.goal and self._lease and self._lease.client == client:
            self._topics.cancel_goals()  # a goal whose client has left would be held
        page = replace(page, lease=request_action(page.lease, request.action, now))
        self._renew(client, page, request.answers, now)

    def _drive(self, client: str, page: _Page, command: Stick, now: float) -> None:
        age = age_of_answer(self._heard, command.answers, now)
        stick, verdict = step_stick(page.stick, command.hold, age, now)
        why = "late"
        if verdict == "drive" and not may_drive(page.lease, self._lease):
            stick, verdict = end_stick(stick)
            why = "driver"
        elif verdict == "drive" and not self._velocities.get_num_connections():
            stick, verdict = end_stick(stick)
            why = "no mux"
        if verdict == "drive":
            page = replace(page, lease=replace(page.lease, ended_at=None))
            began = command.hold != page.stick.hold and self._lease is not None
            if began and self._lease is not None and self._lease.client != client:
                page = replace(page, lease=request_action(page.lease, "acquire", now))
                self._request(page, "acquire", command.answers)
            forward, turn = self._limits
            self._publish(
                page,
                command.answers,
                max(-forward, min(forward, command.forward)),
                max(-turn, min(turn, command.turn)),
            )
        self._step(client, page, (stick, verdict), why)

    def _step(self, client: str, page: _Page, step: tuple[StickState, Verdict], why: str) -> None:
        stick, verdict = step
        self._pages[client] = replace(page, stick=stick)
        self._finish(page, verdict, why)
        if verdict == "over" and why:
            self._reply(client, {"t": "over", "hold": stick.hold, "why": why})

    def _finish(self, page: _Page, verdict: Verdict, why: str) -> None:
        """Send a stop at once where a press is over; the mux would find out a moment later by itself."""
        newest = self._heard.newest
        if verdict == "over" and why != "driver" and newest is not None and may_drive(page.lease, self._lease):
            self._publish(page, newest, 0.0, 0.0)

    def _publish(self, page: _Page, answer: Stamp, forward: float, turn: float) -> None:
        message = TwistStamped(twist=Twist(Vector3(forward, 0.0, 0.0), Vector3(0.0, 0.0, turn)))
        message.header.stamp, message.header.frame_id = rospy.Time(*answer), page.lease.client
        self._velocities.publish(message)

    def _renew(self, client: str, page: _Page, answer: Stamp, now: float) -> None:
        goal = self._topics.goal(time.monotonic())
        if page.goal and (goal.number != page.goal or goal.over):
            page = replace(page, goal=0, lease=note_end(page.lease, now))
        lease, action = step_page(page.lease, self._lease, now)
        page = self._pages[client] = replace(page, lease=lease)
        if action is not None:
            self._request(page, action, answer)

    def _request(self, page: _Page, action: Action, answer: Stamp) -> None:
        request = LeaseRequest(page.lease.client, page.name, _PROGRAM, action, True, answer, page.lease.computer)
        self._requests.publish(String(write_request(request)))

    def _navigate(self, client: str, page: _Page, request: Goal | InitialPose | Resume, now: float) -> None:
        """Requests that set something in motion, or change where it goes: refused when they are late."""
        what = {Goal: "goal", InitialPose: "pose", Resume: "resume"}[type(request)]
        age = age_of_answer(self._heard, request.answers, now)
        late = age is None or age > REQUEST_FRESHNESS
        if late and (self._lease is not None or self._heard.newest is not None):
            self._refuse(client, page, what, "late", now)
        elif not may_drive(page.lease, self._lease):
            self._refuse(client, page, what, "driver", now)
        elif isinstance(request, Resume):
            self._topics.continue_goal(rospy.Time(*request.answers))
        elif isinstance(request, InitialPose):
            self._topics.set_pose(Pose2(request.x, request.y, request.yaw))
        else:
            self._go(client, page, request, now)

    def _ask_patrol(self, client: str, page: _Page, request: AskPatrol) -> None:
        def answer(problem: str) -> None:
            what = {"t": "refused", "why": problem} if problem else {"t": "done"}
            self._reply(client, {**what, "what": "patrol"})

        name = f"{client[:40]}-{next(self._numbers)}"
        ask_patrol(self._patrol, self._places, request, name, page.lease.client, page.name, answer)

    def _refuse(self, client: str, page: _Page, what: str, why: str, now: float) -> None:
        """Refuse a request; a lease that its page has without driving to a goal goes back."""
        if not page.goal:
            self._pages[client] = replace(page, lease=note_end(page.lease, now))
        self._reply(client, {"t": "refused", "what": what, "why": why})

    def _go(self, client: str, page: _Page, goal: Goal, now: float) -> None:
        goal_id, yaw = f"{rospy.get_name()}-{next(self._numbers)}-{time.time():.3f}", goal.yaw
        if yaw is None:
            goal_id = write_any_heading(goal_id)
            yaw = heading_there(self._topics.robot.pose(), goal.x, goal.y)
        if self._lease is not None:
            if self._lease.client != client:
                page = replace(page, lease=request_action(page.lease, "acquire", now))
                self._request(page, "acquire", goal.answers)
            goal_id = write_goal_id(goal_id, page.lease.client, goal.answers[0] * _NANO + goal.answers[1])
        number = self._topics.send_goal(goal_id, Pose2(goal.x, goal.y, yaw))
        self._pages[client] = replace(page, goal=number, lease=replace(page.lease, ended_at=None))
        self._reply(client, {"t": "sent", "what": "goal", "number": number})

    @quiet_at_end
    def _on_lease(self, message: String) -> None:
        lease = read_lease(message.data)
        if lease is not None:
            with self._lock:
                self._lease = lease

    @quiet_at_end
    def _on_challenge(self, message: Time) -> None:
        stamp = (message.data.secs, message.data.nsecs)
        with self._lock:
            self._heard_at = read_steady_time()
            self._heard = hear(self._heard, stamp, self._heard_at)
        self._announce(stamp)
        self.expire()
