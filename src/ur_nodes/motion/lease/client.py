"""A client of the lease: requests, renewals, and who drives."""

import os
from collections.abc import Callable

from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS
from ur_nodes.motion.challenge.link import ChallengeLink
from ur_nodes.motion.lease.requests import LeaseRequests, apply_lease, let_go, step_requests, want
from ur_nodes.motion.lease.text import Action, Lease, LeaseRequest, read_lease, write_request
from ur_nodes.motion.lease.view import Conduct, Identity, LeaseView, identify
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality

_PERIOD = 0.2  # s: of renewals, and of requests that have not taken effect


class LeaseClient:
    """Takes part in the lease of a mux. `view` may be called from any thread.

    At the start it behaves as UR_LEASE specifies: `take` takes the lease, `ask` asks for it, `watch` does nothing, and
    so does `drive`, until its first command, unless a program of this computer has lost the lease. What comes of a
    request is in later views.
    """

    def __init__(
        self,
        node: Node,
        mux: str,
        program: str = "",
        *,
        conduct: Conduct | None = None,
        identity: Identity | None = None,
        link: ChallengeLink | None = None,
        on_challenge: Callable[[], None] | None = None,
        hangs: Callable[[], bool] = lambda: False,
    ) -> None:
        """`mux` is the node that has the lease; `conduct` overrides UR_LEASE, `identity` the environment.

        While the program `hangs` nothing is renewed: the mux then holds its goal as if the client were out of reach.
        """
        self.identity = identity or identify(os.environ, program or node.name.strip("/"))
        self.conduct: Conduct = conduct or self.identity.conduct
        self.link = link or ChallengeLink(node, mux, on_challenge)
        self._node, self._hangs = node, hangs
        self._note = ""
        self._requests = LeaseRequests(self.client, self.conduct)
        self._publisher = node.publish(f"{mux}/lease_request", str, Quality.EVERY)
        node.subscribe(f"{mux}/lease", str, self._on_lease, Quality.LATCHED_EVERY)  # take-overs that ended count, too
        node.every(_PERIOD, self._step, steady=True)

    @property
    def client(self) -> str:
        """The id of this client, for stamped commands."""
        return self.identity.client

    def view(self) -> LeaseView:
        """Return this client's view of the lease."""
        return self._requests.view(self.link.link_age())

    @property
    def taken_over(self) -> Lease | None:
        """Return the lease of the client that took it over from this one, until this one has it again."""
        return self._requests.taken_over

    @property
    def settled(self) -> bool:
        """Return whether the first request has taken effect or was given up."""
        return self._requests.settled

    def acquire(self) -> None:
        """Acquire the lease if it is free, or was lost by a client of the same user on the same computer."""
        self.request("acquire")

    def take_over(self) -> None:
        """Take the lease from its holder."""
        self.request("take")

    def ask(self) -> None:
        """Ask the holder for the lease; acquire it when it is free."""
        self.request("ask")

    def grant(self) -> None:
        """Hand the lease over to the first client that asks."""
        self.request("grant")

    def request(self, action: Action) -> None:
        """Request an action until it has taken effect."""
        self._requests = want(self._requests, action, self._node.steady())
        self._step()

    def release(self, *, final: bool = True, note: str = "") -> None:
        """Release the lease, or stop asking.

        With `final` nothing is sent afterwards: for the end of a program. Other screens show `note` as the reason.
        """
        self._note = note or self._note
        begun = self._requests.begun
        self._requests = let_go(self._requests, silent=final)
        if begun:
            self._send("release")

    def _step(self) -> None:
        if self._hangs():
            return
        linked = self.link.newest(REQUEST_FRESHNESS / 2.0) is not None and self._publisher.subscribers() > 0
        self._requests, action = step_requests(self._requests, self._node.steady(), linked=linked)
        if action:
            self._send(action)

    def _send(self, action: Action) -> None:
        answer = self.link.newest(REQUEST_FRESHNESS / 2.0)
        if answer is not None:
            who, (seconds, rest) = self.identity, divmod(answer, SECOND)
            request = LeaseRequest(
                *(who.client, who.name, who.program, action, who.attended, (seconds, rest), who.computer),
                note=self._note if action == "release" else "",
            )
            self._publisher.send(write_request(request))

    def _on_lease(self, text: str) -> None:
        lease = read_lease(text)
        if lease is not None:
            self._requests = apply_lease(self._requests, lease)
