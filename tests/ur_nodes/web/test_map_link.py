"""The map in use and the request to save one, through the robot's end as a process with a real master."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.ros_session import RosSession
from tests.ur_nodes.web.test_robot_end_node import read_frames

from ur.web.wire.frames import Kind, key_of

SAVER = """
import rospy
from std_srvs.srv import Trigger, TriggerResponse

rospy.init_node("slam_gmapping")
answers = iter([(True, "flat"), (False, "the disk is full"), (True, "../x")])
rospy.set_param("/teleop_twist_keyboard/save_service", "slam_gmapping/save")
rospy.Service("slam_gmapping/save", Trigger, lambda _: TriggerResponse(*next(answers)))
rospy.spin()
"""
SERVER = """
import rospy
from nav_msgs.srv import GetMap

rospy.init_node("map_server")
rospy.set_param("/keyboard_navigate/map_name", "flat")  # its node may be left out
rospy.Service("static_map", GetMap, lambda _: None)
rospy.spin()
"""


def test_only_names_of_services_and_of_stored_maps_count() -> None:
    from ur_nodes.web.map_link_node import choose_name, choose_service

    assert choose_service(["", 7, None, "no service", "a/b", "c"]) == "a/b"
    assert choose_service(["http://x", "//", "x" * 300]) == ""
    assert choose_name("flat", made=False) == "flat"
    assert choose_name("flat", made=True) == ""
    for value in ("", "/opt/maps/maze.yaml", "latest", "a b", 7, None, ["flat"]):
        assert choose_name(value, made=False) == ""


@pytest.fixture
def session(tmp_path: Path) -> Iterator[RosSession]:
    session = RosSession(tmp_path)
    try:
        yield session
    finally:
        session.close()


def wait_for_map(view: socket.socket, wanted: dict[str, Any]) -> None:
    for frame in read_frames(view):
        if key_of(frame)[0] == Kind.STATE and json.loads(frame[frame.index(b"{") :])["map"] == wanted:
            return
    raise AssertionError("the robot's end has ended")


@pytest.mark.ros
@pytest.mark.timeout(300)
def test_page_is_told_the_map_in_use_and_saves_the_one_that_is_made(session: RosSession) -> None:
    (view, its_view), (drive, its_drive) = socket.socketpair(), socket.socketpair()
    words = ("ur_nodes.web.robot_end_node", str(its_view.fileno()), str(its_drive.fileno()))
    session.start(sys.executable, "-c", SERVER)
    node = subprocess.Popen(
        [sys.executable, "-I", "-m", "ur_nodes", *words],
        env=session.env,
        pass_fds=(its_view.fileno(), its_drive.fileno()),
    )
    try:
        its_view.close()
        its_drive.close()
        view.settimeout(120.0)
        drive.settimeout(120.0)
        view.sendall(b'{"viewers": 1, "layers": [], "plots": []}\n')
        wait_for_map(view, {"name": "flat", "saves": False})
        lines = drive.makefile("rb")

        def save() -> dict[str, Any]:
            drive.sendall(b'{"page": "web-a", "m": "{\\"t\\": \\"save_map\\"}"}\n')
            while (found := json.loads(next(lines))).get("page") != "web-a":
                pass
            return dict(found["m"])

        drive.sendall(b'{"do": "come", "page": "web-a", "name": "a", "computer": "b"}\n')
        assert save() == {"t": "refused", "why": "no map", "what": "save_map"}
        session.start(sys.executable, "-c", SAVER)
        wait_for_map(view, {"name": "", "saves": True})
        assert save() == {"t": "done", "name": "flat", "what": "save_map"}
        assert save() == {"t": "refused", "why": "the disk is full", "what": "save_map"}
        assert "no name of a map" in save()["why"]
    finally:
        view.close()
        drive.close()
        node.communicate(timeout=60)
