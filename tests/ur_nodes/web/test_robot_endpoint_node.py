"""The robot's end of the page as a process with a real master: hostile numbers reach it, and frames go on."""

from __future__ import annotations

import json
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ros_session import RosSession

from ur.web.wire.frames import LENGTH, Kind, key_of

pytestmark = [pytest.mark.ros, pytest.mark.timeout(300)]

PUBLISHER = """
import rospy
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

rospy.init_node("far_away")
publisher = rospy.Publisher("/tf", TFMessage, queue_size=1)
while not rospy.is_shutdown():
    message = TFMessage()
    for parent, child, x in (("map", "odom", 1e39), ("odom", "base_link", 0.0), ("odom", "base_footprint", 0.0)):
        transform = TransformStamped()
        transform.header.stamp = rospy.Time.now()
        transform.header.frame_id, transform.child_frame_id = parent, child
        transform.transform.translation.x, transform.transform.rotation.w = x, 1.0
        message.transforms.append(transform)
    publisher.publish(message)
    rospy.sleep(0.05)
"""


@pytest.fixture
def session(tmp_path: Path) -> Iterator[RosSession]:
    session = RosSession(tmp_path)
    try:
        yield session
    finally:
        session.close()


def read_frames(view: socket.socket) -> Iterator[bytes]:
    with view.makefile("rb") as file:
        while head := file.read(LENGTH.size):
            yield file.read(LENGTH.unpack(head)[0])


def test_frames_go_on_by_odometry_while_the_place_on_the_map_is_out_of_all_measure(session: RosSession) -> None:
    (view, its_view), (drive, its_drive) = socket.socketpair(), socket.socketpair()
    words = ("ur_nodes.web.robot_endpoint_node", str(its_view.fileno()), str(its_drive.fileno()))
    node = subprocess.Popen(
        [sys.executable, "-I", "-m", "ur_nodes", *words],
        env=session.env,
        pass_fds=(its_view.fileno(), its_drive.fileno()),
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        its_view.close()
        its_drive.close()
        view.settimeout(240.0)
        view.sendall(json.dumps({"viewers": 1, "layers": [], "plots": []}).encode() + b"\n")
        session.start(sys.executable, "-c", PUBLISHER)
        by_odometry = 0
        for frame in read_frames(view):
            if key_of(frame)[0] == Kind.POSE:
                x = struct.unpack_from("<f", frame, 6)[0]
                by_odometry += x == 0.0
            if by_odometry == 20:
                break
        assert by_odometry == 20, node.communicate(timeout=60)[1]
    finally:
        view.close()
        drive.close()
        node.communicate(timeout=60)
