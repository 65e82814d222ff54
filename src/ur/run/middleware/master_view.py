"""The graph as a master of ROS 1 knows it, and topics received directly from their publishers."""

from __future__ import annotations

import select
import time
from collections.abc import Collection
from contextlib import suppress

from ur.run.master.client import CALLER, Master
from ur.run.master.tcpros import NoTopic, TopicConnection, listen_to, read_frames
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.middleware.protocol import TF_TOPICS, NoGraph, ReceivedMessages, RunGraph

_TIMEOUT = 1.0  # s that a publisher gets to answer


class MasterView:
    """See `GraphView`."""

    def __init__(self, master: Master) -> None:
        self._master = master
        self._listeners: dict[tuple[str, str], TopicConnection] = {}
        self.received: dict[str, ReceivedMessages] = {}

    def look(self, topics: Collection[str]) -> RunGraph:
        try:
            publishers, subscribers, services = (dict(kind) for kind in self._master.get_system_state())
        except (Unanswered, CallRefused, ValueError, TypeError) as problem:
            raise NoGraph(f"the master does not answer: {problem}") from None
        graph = RunGraph(publishers, subscribers, services)
        self._connect(topics, graph)
        return graph

    def wait(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while self._listeners and (left := end - time.monotonic()) > 0:
            keys = {listener.fileno(): key for key, listener in self._listeners.items()}
            for descriptor in select.select(list(keys), [], [], left)[0]:
                self._receive(keys[descriptor])
        if (left := end - time.monotonic()) > 0:
            time.sleep(left)

    def forget(self) -> None:
        for listener in self._listeners.values():
            listener.close()
        self._listeners.clear()
        self.received.clear()

    def _connect(self, topics: Collection[str], graph: RunGraph) -> None:
        for topic in topics:
            for node in graph.publishers.get(topic, ()):
                if (topic, node) in self._listeners:
                    continue
                with suppress(NoTopic, Unanswered, CallRefused):  # it is asked again at the next look
                    uri = self._master.call("lookupNode", node)
                    keep = 1 << 20 if topic in TF_TOPICS else 0
                    listener = listen_to(uri, topic, keep=keep, timeout=_TIMEOUT, caller=CALLER)
                    self._listeners[topic, node] = listener
                    self.received.setdefault(topic, ReceivedMessages())

    def _receive(self, key: tuple[str, str]) -> None:
        received = self.received[key[0]]
        try:
            messages = self._listeners[key].receive()
        except NoTopic:
            self._listeners.pop(key).close()
            return
        received.times.extend([time.monotonic()] * len(messages))
        if key[0] in TF_TOPICS:
            received.frames.update(*(read_frames(message) for message in messages))
