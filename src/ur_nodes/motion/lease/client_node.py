"""A client of the lease over ROS: requests, renewals, and who drives."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable

import rospy
from std_msgs.msg import String

from ur_nodes.motion.challenge.challenge_node import ChallengeLink
from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS
from ur_nodes.motion.lease.text import Action, Lease, Request, read_lease, write_request
from ur_nodes.motion.lease.view import Conduct, Identity, LeaseView, first_action, identify, is_settled, view_lease

_PERIOD = 0.2  # s: of renewals, and of requests that have not taken effect
_PATIENCE = 2.0  # s: then a request that has not taken effect is given up
_START_PATIENCE = 4.5  # s: likewise at the start; by then a holder that was killed just before is lost
_LAST_WORDS = 0.1  # s: for a release to leave before the connections close


class LeaseClient:
    """Takes part in the lease of a mux, in a thread of its own. No call but `release` blocks.

    At the start it behaves as UR_LEASE demands: `take` takes the lease, `ask` asks for it, `watch` does nothing, and so
    does `drive`, until its first command, unless a program of this computer has lost the lease. What comes of a request
    is in later views.
    """

    def __init__(
        self,
        mux: str,
        program: str = "",
        *,
        conduct: Conduct | None = None,
        identity: Identity | None = None,
        on_challenge: Callable[[], None] | None = None,
    ) -> None:
        """`mux` is the node that has the lease; `conduct` overrides UR_LEASE, `identity` the environment."""
        self.identity = identity or identify(os.environ, program or rospy.get_name().strip("/"))
        self.conduct: Conduct = conduct or self.identity.conduct
        self.link = ChallengeLink(mux, on_challenge)
        self._lock = threading.Condition()
        self._lease: Lease | None = None
        self._taken: Lease | None = None
        self._intent: Action | None = None
        self._give_up_at = 0.0
        self._begun = False
        self._released = False
        self._publisher = rospy.Publisher(f"{mux}/lease_request", String, queue_size=5, tcp_nodelay=True)
        rospy.Subscriber(f"{mux}/lease", String, self._on_lease, queue_size=1, tcp_nodelay=True)
        threading.Thread(target=self._run, name="lease", daemon=True).start()

    @property
    def client(self) -> str:
        """The id of this client, for the `frame_id` of stamped commands."""
        return self.identity.client

    def answer(self) -> rospy.Time | None:
        """The newest challenge if it was received within the last 0.15 s."""
        return self.link.answer()

    def view(self) -> LeaseView:
        """Return this client's view of the lease."""
        with self._lock:
            pending = not self._released and not (self._begun and self._intent is None)
            return view_lease(self._lease, self.client, self._taken, self.link.link_age(), pending=pending)

    def acquire(self) -> None:
        """Acquire the lease if it is free, or was lost by a client of the same user on the same computer."""
        self._want("acquire")

    def take(self) -> None:
        """Take the lease from its holder."""
        self._want("take")

    def ask(self) -> None:
        """Ask the holder for the lease; acquire it when it is free."""
        self._want("ask")

    def grant(self) -> None:
        """Hand over to the first who asks."""
        self._want("grant")

    def release(self, *, final: bool = True) -> None:
        """Let others drive, or ask no more. With `final` nothing is sent afterwards: for the end of a program."""
        with self._lock:
            self._intent, self._released, begun = None, final, self._begun
        if begun and self._send("release") and final:
            time.sleep(_LAST_WORDS)

    def settle(self, timeout: float) -> LeaseView:
        """Wait until the first request has taken effect or is given up, at most `timeout` s, and return the view."""
        with self._lock:
            self._lock.wait_for(lambda: self._begun and self._intent is None, timeout)
        return self.view()

    def _want(self, action: Action) -> None:
        with self._lock:
            self._begun, self._released = True, False
            self._intent, self._give_up_at = action, time.monotonic() + _PATIENCE
        self._tick()

    def _run(self) -> None:
        while not rospy.is_shutdown():
            self._tick()
            time.sleep(_PERIOD)

    def _tick(self) -> None:
        """Send what is due."""
        with self._lock:
            if self._lease is None or self._released:
                return
            if not self._begun and self.link.answer(REQUEST_FRESHNESS / 2.0) and self._publisher.get_num_connections():
                self._begun = True
                self._intent, self._give_up_at = (
                    first_action(self.conduct, self._lease),
                    time.monotonic() + _START_PATIENCE,
                )
            if self._intent and (
                is_settled(self._intent, self._lease, self.client) or time.monotonic() > self._give_up_at
            ):
                self._intent = None
            action: Action = self._intent or "renew"
            self._lock.notify_all()
            if not self._begun or (self.conduct == "watch" and not self._takes_part()):
                return
        self._send(action)

    def _takes_part(self) -> bool:
        lease = self._lease
        return self._intent is not None or (
            lease is not None
            and (lease.client == self.client or any(each.client == self.client for each in lease.asking))
        )

    def _send(self, action: Action) -> bool:
        answer = self.link.answer(REQUEST_FRESHNESS / 2.0)
        if answer is None:
            return False
        who = self.identity
        stamp = (answer.secs, answer.nsecs)
        request = Request(who.client, who.name, who.program, action, who.attended, stamp, who.computer)
        try:
            self._publisher.publish(String(write_request(request)))
        except rospy.ROSException:
            return False  # the node is ending
        return True

    def _on_lease(self, message: String) -> None:
        lease = read_lease(message.data)
        if lease is None:
            return
        with self._lock:
            if lease.client == self.client:
                self._taken = None
            elif lease.taken_from is not None and lease.taken_from.client == self.client:
                self._taken = lease
            self._lease = lease
            if self._intent and is_settled(self._intent, lease, self.client):
                self._intent = None
            self._lock.notify_all()
