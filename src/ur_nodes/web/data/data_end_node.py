"""Reads data of the robot for pages: a node that the server starts, connected to it by a socket that it inherits.

    python -I -m ur_nodes ur_nodes.web.data.data_end_node LINK

LINK is a descriptor. Requests of pages arrive as lines, frames (`ur.web.wire.data_frames`) leave. All that a topic
holds is decoded here and not where the robot is driven from. The node ends when LINK is closed, or when another master
has started.
"""

from __future__ import annotations

import json
import os
import re
import socket
import sys
import threading
import time
from collections.abc import Mapping
from typing import Any

import rospy

from ur.web.wire.data_frames import ALL, pack_json
from ur.web.wire.data_requests import Show, read_data_request
from ur.web.wire.frames import LENGTH
from ur.web.wire.reading import BadRequestError
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.shell import run_node
from ur_nodes.web.data.actions_node import Actions
from ur_nodes.web.data.graph_node import RosGraph, read_graph
from ur_nodes.web.data.topics_node import TopicWatch
from ur_nodes.web.layers.pacing import Every
from ur_nodes.web.scene.scene_node import SceneFeed
from ur_nodes.web.status.status_node import StatusFeed

_TICK = 0.05  # s
_GRAPH_EVERY = 2.0  # s
_MASTER_EVERY = 2.0  # s


class DataEnd:
    """Joins the socket to what pages show and ask for."""

    def __init__(self, link: socket.socket) -> None:
        self._link = link
        self._sending, self._lock = threading.Lock(), threading.Lock()
        self._shows: dict[int, Show] = {}
        self._graph = RosGraph()
        self._graph_every, self._master_every = Every(_GRAPH_EVERY), Every(_MASTER_EVERY)
        self._run_id = rospy.get_param("/run_id", "")
        self._topics, self._status, self._scene = TopicWatch(self._send), StatusFeed(self._send), SceneFeed(self._send)
        self._actions = Actions(lambda: read_graph(rospy.get_name()) or self._graph)
        self._send(pack_json(ALL, "hello", {"t": "hello"}))
        for target in (self._read, self._run):
            threading.Thread(target=target, name=target.__name__, daemon=True).start()

    def _send(self, frame: bytes) -> None:
        try:
            with self._sending:
                self._link.sendall(LENGTH.pack(len(frame)) + frame)
        except OSError:
            rospy.signal_shutdown("the server is gone")

    def _read(self) -> None:
        with self._link.makefile("rb") as file:
            try:
                for line in file:
                    value = json.loads(line)
                    self._take(int(value["page"]), str(value["m"]))
            except OSError:
                pass
        rospy.signal_shutdown("the server is gone")

    def _take(self, page: int, text: str) -> None:
        if not text:
            with self._lock:
                self._shows.pop(page, None)
            return
        try:
            envelope = read_data_request(text)
        except BadRequestError:
            return  # the server has let only good ones through
        if isinstance(envelope.request, Show):
            with self._lock:
                self._shows[page] = envelope.request
            self._topics.hurry()
            return

        def answer(found: Mapping[str, Any]) -> None:
            value = {"t": "answer", "id": envelope.number, **found}
            try:
                self._send(pack_json(page, "", value))
            except ValueError:  # a number that JSON lacks, of a parameter
                self._send(pack_json(page, "", {**value, "ok": False, "text": "not a finite number", "value": None}))

        self._actions.take(envelope.request, answer)

    @quiet_at_end
    def _run(self) -> None:
        while not rospy.is_shutdown():
            now = time.monotonic()
            with self._lock:
                shows = dict(self._shows)
            if shows and self._graph_every.due(now):
                self._graph = read_graph(rospy.get_name()) or self._graph
            self._topics.step(now, shows, self._graph)
            self._status.step(now, [page for page, each in shows.items() if each.status])
            self._scene.step(now, shows, self._graph)
            self._actions.expire(now)
            if self._master_every.due(now):
                self._follow_master()
            time.sleep(_TICK)

    def _follow_master(self) -> None:
        try:
            run_id = rospy.get_param("/run_id", "")
        except Exception:  # a master that answers wrongly is not another one
            return
        if run_id != self._run_id:
            rospy.signal_shutdown("another master has started")


def main() -> int:
    """Run until the server is gone. Returns the exit code."""
    link = socket.socket(fileno=int(sys.argv[1]))
    host = re.sub(r"\W", "_", socket.gethostname().split(".")[0], flags=re.ASCII)
    return run_node(f"web_data_{host}_{os.getpid()}", lambda: _start(link), own_terminal=True)


def _start(link: socket.socket) -> None:
    DataEnd(link)


if __name__ == "__main__":
    sys.exit(main())
