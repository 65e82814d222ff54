"""`lease.client` for nodes that still use rospy's threads."""

from __future__ import annotations

import time
from collections.abc import Callable

import rospy

from ur_nodes.motion.challenge.challenge_node import ChallengeLink
from ur_nodes.motion.lease import client as ports
from ur_nodes.motion.lease.text import Action
from ur_nodes.motion.lease.view import Conduct, Identity, LeaseView
from ur_nodes.ros1.node import RosNode

_LAST_WORDS = 0.1  # s: for a release to leave before the connections close
_POLL = 0.01  # s


class LeaseClient(ports.LeaseClient):
    """Works on a thread of its own. No call but `release` and `settle` blocks."""

    link: ChallengeLink

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
        self._own = RosNode()
        link = ChallengeLink(mux, on_challenge, self._own)
        super().__init__(self._own, mux, program, conduct=conduct, identity=identity, link=link)
        self._own.begin()

    def answer(self) -> rospy.Time | None:
        """The newest challenge if it was received within the last 0.15 s."""
        return self.link.answer()

    def request(self, action: Action) -> None:
        """Request an action until it has taken effect."""
        self._own.ask(lambda: super(LeaseClient, self).request(action))

    def release(self, *, final: bool = True) -> None:
        """Let others drive, or ask no more. With `final` nothing is sent afterwards: for the end of a program."""
        begun = self._requests.begun
        self._own.ask(lambda: super(LeaseClient, self).release(final=final))
        if begun and final:
            time.sleep(_LAST_WORDS)

    def settle(self, timeout: float) -> LeaseView:
        """Wait until the first request has taken effect or is given up, at most `timeout` s, and return the view."""
        end = time.monotonic() + timeout
        while not self.settled and time.monotonic() < end:
            time.sleep(_POLL)
        return self.view()
