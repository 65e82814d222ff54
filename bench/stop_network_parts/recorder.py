"""Notes by the monotonic clock what muxes send the motors, their leases, and the true motion of a simulated robot."""

from __future__ import annotations

import json
import os
import struct
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import String

_RECORD = struct.Struct("=ddd")


RESTS = (0.01, 0.02)  # m/s, rad/s: less is rest
_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_APPEND


class Output(NamedTuple):
    """A velocity that arrived at the motors: monotonic seconds, m/s, rad/s."""

    at: float
    forward: float
    turn: float


def read_outputs(path: Path) -> list[Output]:
    """All that was noted in a file; nothing when there is none."""
    data = path.read_bytes() if path.exists() else b""
    whole = len(data) - len(data) % _RECORD.size
    return [Output(*record) for record in _RECORD.iter_unpack(data[:whole])]


class Truth(NamedTuple):
    """The true motion of a simulated robot: monotonic seconds, m/s, rad/s."""

    at: float
    forward: float
    turn: float

    @property
    def moves(self) -> int:
        """1 while it moves, else 0."""
        return int(abs(self.forward) >= RESTS[0] or abs(self.turn) >= RESTS[1])


def read_truth(path: Path) -> list[Truth]:
    """All that was noted in a file; nothing when there is none."""
    return [Truth(*output) for output in read_outputs(path)]


class LeaseNote(NamedTuple):
    """A lease as the mux published it (see ur_nodes.motion.lease.text): monotonic seconds, its JSON as a mapping."""

    at: float
    lease: dict[str, Any]


def read_leases(path: Path) -> list[LeaseNote]:
    """All that was noted in a file; nothing when there is none."""
    lines = path.read_text().splitlines() if path.exists() else []
    return [LeaseNote(float(at), json.loads(text)) for at, text in (line.split(" ", 1) for line in lines)]


def main() -> int:
    """Record lanes until shutdown: recorder FOLDER LANE=PREFIX.... Returns the exit code."""
    folder, *lanes = (word for word in sys.argv[1:] if ":=" not in word)
    rospy.init_node("recorder")
    for name in lanes:
        lane, _, prefix = name.partition("=")
        file = os.open(Path(folder, f"{lane}.outputs"), _FLAGS, 0o644)
        rospy.Subscriber(f"{prefix}/cmd_vel", Twist, _note, file, queue_size=100, tcp_nodelay=True)
        file = os.open(Path(folder, f"{lane}.leases"), _FLAGS, 0o644)
        rospy.Subscriber(f"{prefix}/cmd_vel_mux/lease", String, _note_lease, file, queue_size=100, tcp_nodelay=True)
        file = os.open(Path(folder, f"{lane}.truth"), _FLAGS, 0o644)
        rospy.Subscriber(f"{prefix}/base_pose_ground_truth", Odometry, _note_truth, file, queue_size=100)
    rospy.spin()
    return 0


def _note(message: Twist, file: int) -> None:
    os.write(file, _RECORD.pack(time.monotonic(), message.linear.x, message.angular.z))


def _note_truth(message: Odometry, file: int) -> None:
    twist = message.twist.twist
    os.write(file, _RECORD.pack(time.monotonic(), twist.linear.x, twist.angular.z))


def _note_lease(message: String, file: int) -> None:
    os.write(file, f"{time.monotonic()} {json.dumps(json.loads(message.data))}\n".encode())
