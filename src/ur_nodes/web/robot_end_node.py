"""The robot's end of the page: a node that the server starts, connected to it by two sockets that it inherits.

    python -I -m ur_nodes ur_nodes.web.robot_end_node VIEW DRIVE

VIEW and DRIVE are descriptors. Frames leave by VIEW; requests of pages, and the answers to them, have DRIVE of their
own, so that they never wait behind a map. The node ends when either is closed, or when another master has started.
"""

from __future__ import annotations

import json
import os
import re
import socket
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from typing import Any

import rospy

from ur.web.wire.frames import LENGTH
from ur_nodes.motion.challenge.freshness import Stamp
from ur_nodes.rosio.shell import run_node
from ur_nodes.teleop.navigator.mux_link_node import MuxLink
from ur_nodes.teleop.navigator.navigation_topics_node import Names, NavigationTopics
from ur_nodes.teleop.navigator.patrol_link_node import PatrolLink
from ur_nodes.web.drive_end_node import DriveEnd
from ur_nodes.web.map_changes_node import MapChanges
from ur_nodes.web.map_link_node import MapLink
from ur_nodes.web.places import Places
from ur_nodes.web.robot_facts_node import RobotFacts
from ur_nodes.web.view_end_node import ViewEnd
from ur_nodes.web.zone_link_node import ZoneLink

_MASTER_EVERY = 2.0  # s
_TICK = 0.1  # s


class RobotEnd:
    """Joins the sockets to the two ends."""

    def __init__(self, view: socket.socket, drive: socket.socket) -> None:
        self._view, self._drive = view, drive
        self._sending, self._showing = threading.Lock(), threading.Lock()
        names = Names()
        topics, mux, facts, places = NavigationTopics(names), MuxLink(names.mux), RobotFacts(), Places()
        zones, patrol, maps = ZoneLink(rospy.get_name()), PatrolLink(), MapLink(rospy.get_name())
        changes, limits = MapChanges(places, zones, maps, self._reply), facts.limits
        self._drives = DriveEnd(names.mux, topics, mux, places, patrol, changes, limits, self._reply, self._announce)
        self._views = ViewEnd(
            topics, mux, self._drives, facts, places, zones, patrol, maps, names.mux, self._send_frame
        )
        self._run_id = rospy.get_param("/run_id", "")
        rospy.on_shutdown(self._drives.leave_all)
        for target in (self._read_view, self._read_drive, self._watch):
            threading.Thread(target=target, name=target.__name__, daemon=True).start()

    def _send_frame(self, frame: bytes) -> None:
        with self._showing:
            self._view.sendall(LENGTH.pack(len(frame)) + frame)

    def _reply(self, client: str, answer: Mapping[str, Any]) -> None:
        self._write({"page": client, "m": answer})

    def _announce(self, challenge: Stamp) -> None:
        self._write({"n": challenge})

    def _write(self, value: Mapping[str, Any]) -> None:
        try:
            with self._sending:
                self._drive.sendall(json.dumps(value, separators=(",", ":")).encode() + b"\n")
        except OSError:
            rospy.signal_shutdown("the server is gone")

    def _read_view(self) -> None:
        for message in _read_lines(self._view):
            layers, plots = message.get("layers", []), message.get("plots", [])
            self._views.look(int(message.get("viewers", 0)), layers, plots, message.get("camera", ""))
        rospy.signal_shutdown("the server is gone")

    def _read_drive(self) -> None:
        for message in _read_lines(self._drive):
            page = str(message.get("page", ""))
            if message.get("do") == "come":
                name, computer = str(message.get("name", "")), str(message.get("computer", ""))
                self._drives.come(page, name, computer, once=message.get("once") is True)
            elif message.get("do") == "name":
                self._drives.rename(page, str(message.get("name", "")))
            elif message.get("do") == "leave":
                self._drives.leave(page)
            elif message.get("do") == "stop":
                self._drives.emergency()
            else:
                self._drives.take(page, str(message.get("m", "")))
        self._drives.leave_all()
        rospy.signal_shutdown("the server is gone")

    def _watch(self) -> None:
        """End presses in time even where challenges stay away, and end with the master that this node belongs to."""
        due = time.monotonic() + _MASTER_EVERY
        while not rospy.is_shutdown():
            time.sleep(_TICK)
            self._drives.expire()
            if time.monotonic() < due:
                continue
            due = time.monotonic() + _MASTER_EVERY
            try:
                run_id = rospy.get_param("/run_id", "")
            except Exception:  # noqa: S112 - a master that answers wrongly is not another one
                continue
            if run_id != self._run_id:
                rospy.signal_shutdown("another master has started")


def _read_lines(sock: socket.socket) -> Iterator[dict[str, Any]]:
    """Yield the JSON objects that arrive, until the other end is closed."""
    with sock.makefile("rb") as file:
        try:
            for line in file:
                yield json.loads(line)
        except OSError:
            return


def main() -> int:
    """Run until the server is gone. Returns the exit code."""
    view, drive = (socket.socket(fileno=int(each)) for each in sys.argv[1:3])
    host = re.sub(r"\W", "_", socket.gethostname().split(".")[0], flags=re.ASCII)
    return run_node(f"web_{host}_{os.getpid()}", lambda: _start(view, drive), own_terminal=True)


def _start(view: socket.socket, drive: socket.socket) -> None:
    RobotEnd(view, drive)


if __name__ == "__main__":
    sys.exit(main())
