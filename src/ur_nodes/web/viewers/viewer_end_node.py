"""Offers the topics of a master to viewers by foxglove-sdk: bytes of ROS 1 pass through and are never decoded.

    python -I -m ur_nodes ur_nodes.web.viewers.viewer_end_node LINK

LINK is the descriptor of a socket. A line of JSON leaves by it: `host` and `port` of the server. The node ends when it
is closed, or when another master has started. It subscribes to a topic while a viewer does.

The server takes everybody who reaches it, web pages of all sites included. So it takes no messages of viewers, and
listens at an address of the loopback interface that is drawn by chance: another site would have to try 2^39 pairs of
address and port. Users of this computer can find it, as they can reach the master.
"""

from __future__ import annotations

import json
import os
import queue
import re
import secrets
import socket
import sys
import threading
import time
from typing import Any

import foxglove
import rospy
from roslib.message import get_message_class

from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.shell import run_node
from ur_nodes.web.viewers.latched import Latched, compare_topics

_PERIOD = 1.0  # s between two looks at the master
_BACKLOG = 64  # messages that wait for a slow viewer; older ones are dropped
_BUFFER = 1 << 24  # bytes of one message


class _Topic:
    """A topic that is offered, and the subscription to it while a viewer wants it."""

    def __init__(self, name: str, channel: foxglove.Channel) -> None:
        self.name, self.channel = name, channel
        self.wanted = 0
        self._subscriber: rospy.Subscriber | None = None
        self._latched = Latched()

    def change(self, by: int) -> None:
        """A viewer has come (1) or is gone (-1)."""
        self.wanted = max(0, self.wanted + by)
        if self.wanted and self._subscriber is None:
            self._subscriber = rospy.Subscriber(
                self.name, rospy.AnyMsg, self._on_message, queue_size=10, buff_size=_BUFFER, tcp_nodelay=True
            )
        elif self.wanted and by > 0:
            for data in list(self._latched.messages.values()):
                self.channel.log(data)
        elif not self.wanted:
            self.end()

    def end(self) -> None:
        """Unsubscribe."""
        if self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber = None
            self._latched = Latched()

    @quiet_at_end
    def _on_message(self, message: Any) -> None:
        data = bytes(message._buff)  # noqa: SLF001 - rospy's own way to the bytes of AnyMsg
        self._latched.note(message._connection_header, data)  # noqa: SLF001 - likewise
        self.channel.log(data)


class ViewerEnd:
    """The server, and a thread that follows the master and the requests of viewers."""

    def __init__(self, link: socket.socket) -> None:
        self._link = link
        self._context = foxglove.Context()
        self._topics: dict[str, _Topic] = {}
        self._unknown: set[str] = set()
        self._requests: queue.SimpleQueue[tuple[str, int]] = queue.SimpleQueue()
        self._run_id = rospy.get_param("/run_id", "")
        self._follow_master()
        self._server = self._serve()
        threading.Thread(target=self._watch_link, name="link", daemon=True).start()
        threading.Thread(target=self._run, name="topics", daemon=True).start()
        rospy.on_shutdown(self._server.stop)
        host, port = self._host, self._server.port
        link.sendall(json.dumps({"host": host, "port": port}).encode() + b"\n")

    def on_subscribe(self, client: Any, channel: Any) -> None:  # noqa: ARG002 - the server's interface
        """A viewer wants a topic."""
        self._requests.put((channel.topic, 1))

    def on_unsubscribe(self, client: Any, channel: Any) -> None:  # noqa: ARG002 - likewise
        """A viewer wants a topic no more."""
        self._requests.put((channel.topic, -1))

    def _serve(self) -> Any:
        self._host = "127." + ".".join(str(1 + secrets.randbelow(254)) for _ in range(3))
        return foxglove.start_server(
            name="ur",
            host=self._host,
            port=0,
            server_listener=self,
            context=self._context,
            message_backlog_size=_BACKLOG,
        )

    def _watch_link(self) -> None:
        try:
            while self._link.recv(1):
                pass
        except OSError:
            pass
        rospy.signal_shutdown("the server is gone")

    def _run(self) -> None:
        due = time.monotonic() + _PERIOD
        while not rospy.is_shutdown():
            try:
                name, by = self._requests.get(timeout=max(0.0, due - time.monotonic()))
            except queue.Empty:
                due = time.monotonic() + _PERIOD
                self._follow_master()
                continue
            topic = self._topics.get(name)
            if topic is not None:
                topic.change(by)

    def _follow_master(self) -> None:
        """Offer what is published now, and end with the master that this node belongs to."""
        try:
            found = rospy.get_published_topics()
            run_id = rospy.get_param("/run_id", "")
        except Exception:  # a master that does not answer now may answer later
            return
        if run_id != self._run_id:
            rospy.signal_shutdown("another master has started")
            return
        offered = {name: topic.channel.schema_name() or "" for name, topic in self._topics.items()}
        gone, new = compare_topics(offered, [(str(name), str(kind)) for name, kind in found])
        for name in gone:
            topic = self._topics.pop(name)
            topic.end()
            topic.channel.close()
        for name, kind in new.items():
            self._offer(name, kind)

    def _offer(self, name: str, kind: str) -> None:
        try:
            found = get_message_class(kind)
        except Exception:  # whatever a package of a workspace raises
            found = None
        if found is None:
            if kind not in self._unknown:
                self._unknown.add(kind)
                sys.stderr.write(f"{name}: not offered: {kind} is not installed on this computer\n")
            return
        schema = foxglove.Schema(name=kind, encoding="ros1msg", data=found._full_text.encode())  # noqa: SLF001 - genpy's
        channel = foxglove.Channel(name, schema=schema, message_encoding="ros1", context=self._context)
        self._topics[name] = _Topic(name, channel)


def main() -> int:
    """Run until the server is gone. Returns the exit code."""
    link = socket.socket(fileno=int(sys.argv[1]))
    host = re.sub(r"\W", "_", socket.gethostname().split(".")[0], flags=re.ASCII)
    return run_node(f"web_viewers_{host}_{os.getpid()}", lambda: _start(link), own_terminal=True)


def _start(link: socket.socket) -> None:
    ViewerEnd(link)


if __name__ == "__main__":
    sys.exit(main())
