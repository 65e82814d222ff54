"""The connection of pages to the mux: velocities, lease requests, and the challenges that bound their age.

The mux checks the age of each command itself, by its own clock. The check here comes before it, so that a page learns
at once that its press is over.
"""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field

from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS, Stamp
from ur_nodes.motion.lease.text import Action, Lease, LeaseRequest, read_lease, write_request
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedTwist, Time, Twist
from ur_nodes.web.driving.page_lease import PageLease

VELOCITIES = "web_vel_stamped"
_PROGRAM = "web"


@dataclass(frozen=True, slots=True)
class ChallengeTimes:
    """Challenges with the time of their arrival, oldest first; `newest` is None before the first."""

    at: OrderedDict[Stamp, float] = field(default_factory=OrderedDict)
    newest: Stamp | None = None


def keep_challenge(received: ChallengeTimes, challenge: Stamp, now: float) -> ChallengeTimes:
    """Add a challenge that has arrived at `now` (s), and drop those that are too old."""
    kept = OrderedDict((each, at) for each, at in received.at.items() if now - at <= REQUEST_FRESHNESS)
    kept[challenge] = now
    return ChallengeTimes(kept, challenge)


def age_of_answer(received: ChallengeTimes, answer: Stamp, now: float) -> float | None:
    """Return the seconds since the answered challenge arrived; None if it did not arrive within the last second."""
    at = received.at.get(answer)
    return max(0.0, now - at) if at is not None and now - at <= REQUEST_FRESHNESS else None


class DriverLink:
    """Sends velocities and lease requests of pages to the mux, within the `limits`: m/s, rad/s, m/s to the side."""

    def __init__(
        self, node: Node, mux: str, limits: tuple[float, float, float], on_challenge: Callable[[Stamp], None]
    ) -> None:
        """`on_challenge` is called with each challenge."""
        self.lease: Lease | None = None
        """The lease; None before the mux has sent one."""
        self._node, self._limits, self._on_challenge = node, limits, on_challenge
        self._received = ChallengeTimes()
        self._received_at = float("-inf")
        self._velocities = node.publish(VELOCITIES, StampedTwist, Quality.FRESH)
        self._speed_limit = node.publish(f"{mux}/speed_limit", float)
        self._requests = node.publish(f"{mux}/lease_request", str, Quality.EVERY)
        node.subscribe(f"{mux}/lease", str, self._on_lease, Quality.LATCHED)
        node.subscribe(f"{mux}/challenge", Time, self._receive_challenge)

    @property
    def newest(self) -> Stamp | None:
        """The newest challenge; None before the first."""
        return self._received.newest

    @property
    def connected(self) -> bool:
        """Return whether a mux takes velocities."""
        return self._velocities.subscribers() > 0

    def link_age(self) -> float:
        """Return the seconds since the mux's last challenge; infinite before the first."""
        return self._node.steady() - self._received_at

    def age_of(self, answer: Stamp) -> float | None:
        """Return the age of an answer in s; None for a challenge that did not arrive within the last second."""
        return age_of_answer(self._received, answer, self._node.steady())

    def is_late(self, answer: Stamp) -> bool:
        """Return whether a request that sets something in motion is too old, where a mux sends challenges."""
        age = self.age_of(answer)
        reported = self.lease is not None or self.newest is not None
        return reported and (age is None or age > REQUEST_FRESHNESS)

    def drive(self, page: PageLease, answer: Stamp, twist: Twist) -> None:
        """Pass a velocity on, within the limits."""
        wanted = (twist.forward, twist.turn, twist.left)
        twist = Twist(*(max(-most, min(most, each)) for most, each in zip(self._limits, wanted, strict=True)))
        self._velocities.send(StampedTwist(number_of(answer), page.client, twist))

    def stop(self, page: PageLease) -> None:
        """Pass a velocity of zero on at once; the mux would stop a moment later by itself."""
        if self.newest is not None:
            self.drive(page, self.newest, Twist(0.0, 0.0))

    def request(self, page: PageLease, name: str, action: Action, answer: Stamp) -> None:
        """Ask for the lease, in the name of a page."""
        request = LeaseRequest(page.client, name, _PROGRAM, action, True, answer, page.computer)
        self._requests.send(write_request(request))

    def limit_speed(self, percent: float) -> None:
        """Limit the speed of all who drive."""
        self._speed_limit.send(float(percent))

    def _on_lease(self, text: str) -> None:
        lease = read_lease(text)
        if lease is not None:
            self.lease = lease

    def _receive_challenge(self, challenge: Time) -> None:
        stamp = divmod(challenge.stamp, SECOND)
        self._received_at = self._node.steady()
        self._received = keep_challenge(self._received, stamp, self._received_at)
        self._on_challenge(stamp)


def number_of(answer: Stamp) -> int:
    """Return the challenge of an answer as a number (ns)."""
    return answer[0] * SECOND + answer[1]
