"""The state of an exploration, for pages."""

from __future__ import annotations

from typing import Any

import rospy
from std_msgs.msg import String

from ur.source.printable import printable
from ur_nodes.exploration.status import Status, describe_status, read_status
from ur_nodes.rosio.ending import quiet_at_end

_LONGEST = 500  # characters of a line


class ExplorationTopic:
    """Subscribes to the status of an exploration."""

    def __init__(self, name: str = "explore/status") -> None:
        self._newest: Status | None = None
        self._subscriber = rospy.Subscriber(name, String, self._take, queue_size=1)

    def describe(self) -> dict[str, Any] | None:
        """Describe it for a page: its state, and the line that a terminal shows; None while nothing explores.

        An exploration that has ended stays: the page shows how.
        """
        status = self._newest
        if status is None or not (status.ended or self._subscriber.get_num_connections()):
            return None
        return {"state": status.state, "line": printable(describe_status(status))[:_LONGEST]}

    @quiet_at_end
    def _take(self, message: String) -> None:
        self._newest = read_status(message.data)
