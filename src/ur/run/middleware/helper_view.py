"""The graph of ROS 2 as a helper node sees it, which runs while the graph is read: `ur` itself imports no ROS."""

import json
import os
import select
import socket
import subprocess
import time
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass

from ur.run.middleware.protocol import TF_TOPICS, NoGraph, ReceivedMessages, RunGraph
from ur.source.foreign.json_values import read_json
from ur.system.ros import node_command

_MODULE = "ur_nodes.web.graph_report_node"
_FIRST = 20.0  # s for the first answer: the node starts
_LATER = 5.0  # s
_END = 3.0  # s
_MOST = 16 << 20  # bytes of an answer


@dataclass(frozen=True, slots=True)
class _Answer:
    """The output of `ur_nodes.web.graph_report_node`."""

    publishers: dict[str, list[str]]
    subscribers: dict[str, list[str]]
    services: dict[str, list[str]]
    nodes: list[str]
    received: dict[str, list[float]]
    frames: list[str]


class HelperView:
    """See `GraphView`."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._environment = environment
        self._process: subprocess.Popen[bytes] | None = None
        self._socket: socket.socket | None = None
        self._data = b""
        self.received: dict[str, ReceivedMessages] = {}

    def look(self, topics: Collection[str]) -> RunGraph:
        frames = any(each in TF_TOPICS for each in topics)
        answer = self._ask({"topics": sorted(each for each in topics if each not in TF_TOPICS), "frames": frames})
        for topic, times in answer.received.items():
            self.received.setdefault(topic, ReceivedMessages()).times.extend(times)
        if frames:
            self.received.setdefault(TF_TOPICS[0], ReceivedMessages()).frames.update(answer.frames)
        return RunGraph(answer.publishers, answer.subscribers, answer.services, frozenset(answer.nodes))

    def wait(self, seconds: float) -> None:
        """See GraphView. The node records received messages."""
        time.sleep(seconds)

    def forget(self) -> None:
        if self._socket is not None:
            self._socket.close()
        if self._process is not None:
            try:
                self._process.wait(_END)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._process = self._socket = None
        self._data = b""
        self.received.clear()

    def _start(self) -> socket.socket:
        ours, theirs = socket.socketpair()
        with theirs:
            command = [*node_command(self._environment), _MODULE, str(theirs.fileno())]
            try:
                self._process = subprocess.Popen(
                    command,
                    env=dict(self._environment),
                    pass_fds=(theirs.fileno(),),
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    start_new_session=True,  # Ctrl-C is for this process, which ends that one
                )
            except OSError as problem:
                ours.close()
                raise NoGraph(f"the node that reads the graph cannot be started: {problem.strerror}") from None
        return ours

    def _ask(self, request: Mapping[str, object]) -> _Answer:
        first = self._socket is None
        link = self._socket = self._socket or self._start()
        end = time.monotonic() + (_FIRST if first else _LATER)
        with suppress(OSError, ValueError):
            link.sendall(json.dumps(request).encode() + b"\n")
            while b"\n" not in self._data and len(self._data) < _MOST:
                if not select.select([link], [], [], max(0.0, end - time.monotonic()))[0]:
                    break
                part = os.read(link.fileno(), 1 << 16)
                if not part:
                    break
                self._data += part
            line, found, self._data = self._data.partition(b"\n")
            if found:
                return read_json(line, _Answer, _MOST)
        self.forget()
        raise NoGraph("the node that reads the graph does not answer")
