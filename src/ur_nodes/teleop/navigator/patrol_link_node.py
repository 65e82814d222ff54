"""The patrol of the robot, as programs for people see it: its status, and requests with the answers to them."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable

import rospy
from std_msgs.msg import String

from ur_nodes.client.patrol_text import PatrolRequest, PatrolStatus, read_status, write_request
from ur_nodes.rosio.ending import quiet_at_end

_MOST_WAITING = 20


class PatrolLink:
    """Shows the patrol and passes requests on. Methods may be called from any thread, and do not block."""

    def __init__(self, node: str = "patrol") -> None:
        """`node` is the name of the node that drives the patrol."""
        self._lock = threading.Lock()
        self._status = PatrolStatus()
        self._waiting: OrderedDict[str, Callable[[str], None]] = OrderedDict()
        self._requests = rospy.Publisher(f"{node}/request", String, queue_size=10)
        self._subscriber = rospy.Subscriber(f"{node}/status", String, self._take, queue_size=1)

    def status(self) -> PatrolStatus | None:
        """Return the newest status; None where no node drives patrols."""
        with self._lock:
            return self._status if self._subscriber.get_num_connections() else None

    def request(self, request: PatrolRequest, done: Callable[[str], None] | None = None) -> bool:
        """Publish a request; `done` is called with why it was refused, or ''. Return False: no node takes it."""
        if not self._requests.get_num_connections():
            return False
        if done is not None:
            with self._lock:
                self._waiting[request.id] = done
                while len(self._waiting) > _MOST_WAITING:
                    self._waiting.popitem(last=False)
        self._requests.publish(String(write_request(request)))
        return True

    @quiet_at_end
    def _take(self, message: String) -> None:
        status = read_status(message.data)
        if status is None:
            rospy.logwarn_throttle(10.0, "the status of the patrol cannot be read and is not shown")
            return
        with self._lock:
            self._status = status
            done = self._waiting.pop(status.answer.id, None) if status.answer else None
        if done is not None and status.answer is not None:
            done(status.answer.problem)
