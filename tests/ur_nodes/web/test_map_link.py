"""The map in use, requests to save one and to change its walls, through the robot's end with a real master."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.ros_session import RosSession
from tests.ur_nodes.web.test_robot_end_node import read_frames

from ur.maps.exchange import import_picture
from ur.maps.picture_file import write_picture
from ur.maps.store import MapStore
from ur.web.wire.frames import TILE, Kind, Layer, key_of

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
    from ur_nodes.web.map_names import choose_name, choose_service

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


class RobotEnd:
    """The robot's end as a process, and a page whose login may drive."""

    def __init__(self, session: RosSession) -> None:
        (self._view, its_view), (self._drive, its_drive) = socket.socketpair(), socket.socketpair()
        fds = (its_view.fileno(), its_drive.fileno())
        words = ("-I", "-m", "ur_nodes", "ur_nodes.web.robot_end_node", *map(str, fds))
        self._node = subprocess.Popen([sys.executable, *words], env=session.env, pass_fds=fds)
        for each in (its_view, its_drive):
            each.close()
        for each in (self._view, self._drive):
            each.settimeout(120.0)
        self._view.sendall(b'{"viewers": 1, "layers": [], "plots": []}\n')
        self._drive.sendall(b'{"do": "come", "page": "web-a", "name": "a", "computer": "b"}\n')
        self._map: dict[str, Any] = {}
        self._cells = np.zeros((0, 0), np.int8)
        self._frames, self._lines = read_frames(self._view), self._drive.makefile("rb")

    def close(self) -> None:
        for each in (self._view, self._drive):
            each.shutdown(socket.SHUT_RDWR)  # files of them are open
            each.close()
        self._node.communicate(timeout=60)

    def _wait_for(self, condition: Callable[[], bool]) -> None:
        while not condition():
            frame = next(self._frames)
            key = key_of(frame)
            if key[0] == Kind.STATE:
                self._map = json.loads(frame[frame.index(b"{") :])["map"]
            elif key == (Kind.TILE, Layer.MAP, 0, 0):
                self._cells = np.frombuffer(zlib.decompress(frame[10:]), np.int8).reshape(TILE, TILE)

    def wait_for_map(self, wanted: dict[str, Any]) -> None:
        self._wait_for(lambda: self._map.items() >= wanted.items())

    def wait_for_cells(self, values: np.ndarray) -> None:
        height, width = values.shape
        self._wait_for(lambda: np.array_equal(self._cells[:height, :width], values))

    def ask(self, **request: Any) -> dict[str, Any]:
        self._drive.sendall(json.dumps({"page": "web-a", "m": json.dumps(request)}).encode() + b"\n")
        while (found := json.loads(next(self._lines))).get("page") != "web-a":
            pass
        return dict(found["m"])


@pytest.fixture
def robot_end(session: RosSession, tmp_path: Path) -> Iterator[RobotEnd]:
    session.env["XDG_DATA_HOME"] = str(tmp_path)
    robot_end = RobotEnd(session)
    try:
        yield robot_end
    finally:
        robot_end.close()


@pytest.mark.ros
@pytest.mark.timeout(300)
def test_page_is_told_the_map_in_use_and_saves_the_one_that_is_made(session: RosSession, robot_end: RobotEnd) -> None:
    session.start(sys.executable, "-c", SERVER)
    unknown = {"name": "", "restorable": False, "why": "no server"}
    robot_end.wait_for_map({"name": "flat", "saves": False, "walls": unknown})
    assert robot_end.ask(t="save_map") == {"t": "refused", "why": "no map", "what": "save_map"}
    session.start(sys.executable, "-c", SAVER)
    robot_end.wait_for_map({"name": "", "saves": True, "walls": unknown | {"why": "made"}})
    assert robot_end.ask(t="save_map") == {"t": "done", "name": "flat", "what": "save_map"}
    assert robot_end.ask(t="save_map") == {"t": "refused", "why": "the disk is full", "what": "save_map"}
    assert "no name of a map" in robot_end.ask(t="save_map")["why"]


def serve_map(session: RosSession, file: Path) -> None:
    session.start(sys.executable, "-I", "-m", "ur_nodes", "ur_nodes.mapping.map_server_node", str(file))


@pytest.mark.ros
@pytest.mark.timeout(300)
def test_walls_that_a_page_draws_are_stored_published_and_restored(
    session: RosSession, robot_end: RobotEnd, tmp_path: Path
) -> None:
    store = MapStore(tmp_path / "ubiquity_launches" / "maps")
    before = np.zeros((20, 30), np.int8)
    import_picture(store, write_picture(tmp_path / "plan", before, 0.1, (0.0, 0.0, 0.0)), "flat")
    draw = {"t": "draw_walls", "map": "flat", "strokes": [[0, 0.2, 0.5, 1, 2.5, 1], [1, 0.4, 1.5, 0, 1.5, 2]]}
    assert robot_end.ask(**draw) == {"t": "refused", "why": "no walls", "what": "draw_walls"}
    serve_map(session, store.picture("flat"))
    robot_end.wait_for_map({"walls": {"name": "flat", "restorable": False, "why": ""}})
    robot_end.wait_for_cells(before)
    assert robot_end.ask(**draw) == {"t": "done", "what": "draw_walls"}
    after = before.copy()
    after[9:11, 4:26] = 100
    after[:, 13:17] = 0
    robot_end.wait_for_cells(after)
    robot_end.wait_for_map({"walls": {"name": "flat", "restorable": True, "why": ""}})
    assert [each.kind for each in store.record("flat").edits] == ["wall", "erase"]
    assert "in use is flat" in robot_end.ask(**draw | {"map": "hall"})["why"]
    assert robot_end.ask(t="restore_walls", map="flat") == {"t": "done", "what": "restore_walls"}
    robot_end.wait_for_cells(before)
    assert robot_end.ask(t="restore_walls", map="flat")["t"] == "refused"


@pytest.mark.ros
@pytest.mark.timeout(300)
def test_walls_of_a_map_that_is_not_stored_stay_as_they_are(
    session: RosSession, robot_end: RobotEnd, tmp_path: Path
) -> None:
    file = write_picture(tmp_path / "plan", np.zeros((5, 5), np.int8), 0.1, (0.0, 0.0, 0.0))
    serve_map(session, file)
    robot_end.wait_for_map({"walls": {"name": "", "restorable": False, "why": "file"}})
    answer = robot_end.ask(t="draw_walls", map="plan", strokes=[[0, 0.2, 0, 0, 1, 1]])
    assert "the map in use is a file" in answer["why"]
