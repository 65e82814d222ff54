"""Velocity commands of `move_base`: with the mux's challenge where the mux takes that, else as upstream's."""

from __future__ import annotations

import rospy
from geometry_msgs.msg import Twist

from ur_nodes.motion.challenge.challenge_node import ChallengeLink, FreshPublisher


class VelocityOutput:
    """Publishes on `cmd_vel`, or on the same name with `_stamped` appended.

    Commands go out stamped with the newest challenge, which bounds their age, as soon as the mux has subscribed to
    them; from then on never plain. A base without our mux has no subscriber there and gets plain ones. This node drives
    for whoever holds the lease, so that its commands name no client.
    """

    def __init__(self, link: ChallengeLink, *, stamped: bool) -> None:
        """`stamped` false: plain commands always."""
        self._plain = rospy.Publisher("cmd_vel", Twist, queue_size=1, tcp_nodelay=True)
        self._stamped = FreshPublisher("cmd_vel", link) if stamped else None
        self._to_mux = False

    def send(self, speed: float, turn: float) -> None:
        """Publish a command, m/s and rad/s. Without a fresh challenge there is none: the robot stops."""
        twist = Twist()
        twist.linear.x, twist.angular.z = speed, turn
        self._to_mux = self._to_mux or (self._stamped is not None and self._stamped.listeners() > 0)
        if self._stamped is None or not self._to_mux:
            self._plain.publish(twist)
        else:
            self._stamped.publish(twist)
