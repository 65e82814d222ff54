"""Nodes that the page's server starts, and the sockets between them: JSON lines arrive, bytes leave."""

import json
import os
import re
import selectors
import socket
import sys
import threading
from collections.abc import Callable, Mapping
from functools import partial

from ur.source.foreign.json_values import read_json
from ur.web.wire.frames import LENGTH
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node
from ur_nodes.run import run

_SERVED = re.compile(r"/(web(_data|_viewers)?|assistant|ur_graph)_\w+_\d+|/rosout|(/\w+)*/_\w+", re.ASCII)
"""Nodes of `run_for_server`, of the master, and the hidden ones of ROS 2's tools."""

_ENDED = "the server has ended"
_RUN_EVERY = 2.0  # s
_MOST_WAITING = 1 << 26  # bytes: a server that takes no more does not work


def run_for_server(name: str, start: Callable[..., object]) -> int:
    """Run a node on the sockets whose descriptors are the arguments; `start` gets the node and them.

    It ends with the server, and when another master has started. Returns the exit code.
    """
    descriptors = [int(each) for each in sys.argv[1:]]
    connections = [socket.socket(fileno=os.dup(each)) for each in descriptors]
    nothing = os.open(os.devnull, os.O_RDWR)
    for each in descriptors:  # those of input and output: what is printed must not reach the server
        os.dup2(nothing, each)
    host = re.sub(r"\W", "_", socket.gethostname().split(".")[0], flags=re.ASCII)

    def begin(node: Node) -> object:
        end_with_run(node)
        return start(node, *connections)

    return run(f"{name}_{host}_{os.getpid()}", begin, own_terminal=True)


def is_alone(graph: Graph, own: str) -> bool:
    """Return whether a graph holds only the node `own`, and others that serve pages and tools."""
    return all(each == own or _SERVED.fullmatch(each) for each in graph.nodes)


def end_with_run(node: Node) -> None:
    """End a node when the run that it belongs to is another one: a new master has the address of the old one."""
    own = node.facts.get("run_id", "")

    def read() -> object:
        try:
            return node.facts.get("run_id", "")
        except Exception:  # a master that answers wrongly is not another one
            return own

    def compare(found: object) -> None:
        if found == own:
            node.after(_RUN_EVERY, ask, steady=True)
        else:
            node.end("another master has started")

    def ask() -> None:
        node.work(read, compare, "run")

    node.after(_RUN_EVERY, ask, steady=True)


def read_lines(node: Node, handlers: Mapping[socket.socket, Callable[[dict[str, object]], None]]) -> None:
    """Read lines of JSON and pass each to its taker on the node's thread; the node ends when a socket closes."""

    def read() -> None:
        selector = selectors.DefaultSelector()
        rests = dict.fromkeys(handlers, b"")
        for each in handlers:
            selector.register(each, selectors.EVENT_READ, each)
        while True:
            for key, _ in selector.select():
                connection = key.data
                try:
                    data = connection.recv(1 << 16)
                except OSError:
                    data = b""
                if not data:
                    node.post(partial(node.end, _ENDED))
                    return
                *lines, rests[connection] = (rests[connection] + data).split(b"\n")
                for line in lines:
                    node.post(partial(handlers[connection], read_json(line, dict[str, object], _MOST_WAITING)))

    threading.Thread(target=read, name="server", daemon=True).start()


class Outlet:
    """Sends through a socket in order, without blocking the node; on the node's thread."""

    def __init__(self, node: Node, connection: socket.socket) -> None:
        self._node, self._connection = node, connection
        self._waiting = bytearray()
        self.busy = False
        """Return whether the server has not taken all that was sent: what can be left out now should be."""

    def send_frame(self, frame: bytes) -> None:
        """Send a frame, with its length before it."""
        self.send(LENGTH.pack(len(frame)) + frame)

    def send_line(self, value: Mapping[str, object]) -> None:
        """Send a line of JSON."""
        self.send(json.dumps(value, separators=(",", ":")).encode() + b"\n")

    def send(self, data: bytes) -> None:
        """Send bytes. The node ends if the server has ended or reads no more."""
        if self.busy:
            self._waiting += data
            if len(self._waiting) > _MOST_WAITING:
                self._node.end("the server reads nothing")
            return
        try:
            sent = self._connection.send(data, socket.MSG_DONTWAIT)
        except BlockingIOError:
            sent = 0
        except OSError:
            self._node.end(_ENDED)
            return
        if sent < len(data):
            self.busy = True
            lane = f"send {self._connection.fileno()}"
            self._node.work(partial(self._send_rest, data[sent:]), self._go_on, lane)

    def _send_rest(self, data: bytes) -> bool:
        try:
            self._connection.sendall(data)
        except OSError:
            return False
        return True

    def _go_on(self, sent: bool) -> None:
        if not sent:
            self._node.end(_ENDED)
            return
        self.busy = False
        waiting, self._waiting = bytes(self._waiting), bytearray()
        if waiting:
            self.send(waiting)
