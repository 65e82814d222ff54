"""A process that records a patrol: `python -m bench.patrol_parts.record`; SIGTERM ends it, and it prints JSON."""

from __future__ import annotations

import json
import math
import signal
import sys
import threading
import time
from typing import Any

import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import String

from ur_nodes.client.patrol_text import read_request, read_status


class Recorder:
    """Notes speeds, states and requests with the time of their arrival."""

    def __init__(self) -> None:
        self.speeds: list[tuple[float, float]] = []
        self.states: list[tuple[float, str]] = []
        self.requests: list[float] = []
        rospy.Subscriber("base_pose_ground_truth", Odometry, self._take_truth, queue_size=100)
        rospy.Subscriber("patrol/status", String, self._take_status, queue_size=100)
        rospy.Subscriber("patrol/request", String, self._take_request, queue_size=100)

    def _take_truth(self, message: Any) -> None:
        twist = message.twist.twist
        self.speeds.append((time.monotonic(), math.hypot(twist.linear.x, twist.angular.z)))

    def _take_status(self, message: String) -> None:
        status = read_status(message.data)
        if status is not None:
            self.states.append((time.monotonic(), status.state))

    def _take_request(self, message: String) -> None:
        if read_request(message.data).action in ("start", "resume"):
            self.requests.append(time.monotonic())


def main() -> None:
    """Record until SIGTERM."""
    ended = threading.Event()
    rospy.init_node("patrol_record", anonymous=True, disable_signals=True)
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    recorder = Recorder()
    while not ended.wait(0.1):
        pass
    json.dump([recorder.speeds, recorder.states, recorder.requests], sys.stdout)
    sys.stdout.flush()
    rospy.signal_shutdown("done")


if __name__ == "__main__":
    main()
