"""Publishers as the simulator wants them."""

from __future__ import annotations

import warnings
from typing import Any

import rospy


def make_publisher(topic: str, kind: Any, queue: int | None) -> rospy.Publisher:
    """A publisher that drops the oldest of more than `queue` unsent messages; None: it waits until each is sent."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)  # rospy takes a missing queue size for a mistake
        return rospy.Publisher(topic, kind, queue_size=queue, tcp_nodelay=True)


def has_subscribers(publisher: rospy.Publisher) -> bool:
    """Return whether anything is connected to a topic: `get_num_connections` without locks, as each tick asks."""
    implementation = publisher.impl
    return implementation is not None and bool(implementation.connections)
