"""Velocity commands of `move_base`: with the mux's challenge if the mux accepts that, else as upstream's."""

from __future__ import annotations

from ur_nodes.motion.challenge.link import ChallengeLink, FreshPublisher
from ur_nodes.navigation.steering.speed_profile import DriveVelocity
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Twist


class VelocityOutput:
    """Publishes on `cmd_vel`, or on the same name with `_stamped` appended.

    Commands are stamped with the newest challenge, which bounds their age, as soon as the mux has subscribed to them;
    after that they are never plain. A base without our mux has no subscriber there and gets plain ones. This node
    drives for the holder of the lease, so that its commands name no client. `share` (0 to 1) is how much of the base's
    speeds the mux lets through: a plan for more would not be kept.
    """

    def __init__(self, link: ChallengeLink, mux: str, *, stamped: bool) -> None:
        """Without `stamped`, commands are always plain."""
        self.share = 1.0
        link.node.subscribe(f"{mux}/speed_limit_in_force", float, self._take_limit, Quality.LATCHED)
        self._plain = link.node.publish("cmd_vel", Twist)
        self._stamped = FreshPublisher("cmd_vel", link) if stamped else None
        self._to_mux = False

    def _take_limit(self, percent: float) -> None:
        self.share = percent / 100.0 if 0.0 < percent <= 100.0 else 1.0

    def send(self, velocity: DriveVelocity) -> None:
        """Publish a command. Without a fresh challenge nothing is sent, and the robot stops."""
        self._to_mux = self._to_mux or (self._stamped is not None and self._stamped.listeners() > 0)
        if self._stamped is None or not self._to_mux:
            self._plain.send(Twist(*velocity))
        else:
            self._stamped.send(Twist(*velocity))
