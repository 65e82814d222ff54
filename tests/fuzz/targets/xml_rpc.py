"""Answers of a ROS master, from a peer on a real socket that sends whatever it likes, at any pace."""

from __future__ import annotations

import random
import socket
import struct
import threading
import time
import zlib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from tests.fuzz.target import Target

from ur.graph.topics import graph_system
from ur.request.remote import connection as master_nodes
from ur.run.master.client import Master
from ur.run.master.tcpros import NoTopic, listen_to
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.middleware.protocol import NoGraph
from ur.run.middleware.ros1 import MasterView
from ur.run.remote.lease import read_lease
from ur.run.remote.signs import look_up_nodes, probe_node
from ur.source.diagnostic import UserError

_PATIENCE = 0.3  # s
_SPARE = 20.0  # s that a busy computer may take beyond the timeout

_WORDS = (
    *(b"<value>", b"</value>", b"<array><data>", b"</data></array>", b"<struct>", b"</struct>", b"<int>1</int>"),
    *(b"<member><name>faultString</name>", b"</member>", b"<fault>", b"</fault>", b"<nil/>", b"<double>nan</double>"),
    *(b"<base64>//8=</base64>", b"<boolean>1</boolean>", b"<i8>", b"<string>", b"&#27;", b"&amp;", b"<!DOCTYPE a ["),
    *(
        b"<!ENTITY a 'b'>]>",
        b"Content-Length: 5",
        b"Content-Length: 99999999",
        b"Transfer-Encoding: chunked",
        b"\r\n\r\n",
    ),
    *(b"HTTP/1.1 200 OK", b"HTTP/1.0 500 x", b"http://127.0.0.1:1/", b"TCPROS", b"encoding='utf-16'"),
)


class _Peer:
    """A server that gives every client the same bytes; how fast, and how it ends, follows from the bytes."""

    def __init__(self, answer: bytes) -> None:
        self._answer = answer
        self._over = threading.Event()
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._server.getsockname()[1]
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def __enter__(self) -> _Peer:
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        with suppress(OSError):
            self._server.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._server.close()

    def _serve(self) -> None:
        while not self._over.is_set():
            try:
                link, _ = self._server.accept()
            except OSError:
                return
            with link, suppress(OSError):
                link.settimeout(1.0)
                link.recv(65536)
                self._answer_to(link)

    def _answer_to(self, link: socket.socket) -> None:
        chance = random.Random(zlib.crc32(self._answer))
        pace = chance.choice(
            ("at once", "at once", "at once", "in parts", "dripping", "without end", "silent", "reset")
        )
        if pace == "at once":
            link.sendall(self._answer)
        elif pace in ("in parts", "dripping"):
            size = 1 if pace == "dripping" else chance.randrange(1, 200)
            for at in range(0, len(self._answer), size):
                if self._over.wait(0.01 if pace == "dripping" else 0.0):
                    return
                link.sendall(self._answer[at : at + size])
        elif pace == "without end":
            end = time.monotonic() + 2 * _PATIENCE
            while time.monotonic() < end and not self._over.is_set():
                link.sendall(self._answer or b"x")
        elif pace == "silent":
            self._over.wait(2 * _PATIENCE)
        else:
            link.sendall(self._answer[: len(self._answer) // 2])
            link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))


def _ask(data: bytes, _: Path) -> None:
    ask = _QUESTIONS[zlib.crc32(data[::-1]) % len(_QUESTIONS)]
    with _Peer(data) as peer:
        begin = time.monotonic()
        with suppress(Unanswered, CallRefused):
            ask(Master(f"http://127.0.0.1:{peer.port}", "127.0.0.1", peer.port, _PATIENCE))
        took = time.monotonic() - begin
    assert took < _SPARE, f"{ask.__name__} takes {took:.0f} s"


def _draw_graph(master: Master) -> None:
    graph_system(master.get_system_state(), ["/a"])


def _list_nodes(master: Master) -> None:
    master_nodes.MASTER_PORT = master.port
    master_nodes.list_node_names("127.0.0.1", _PATIENCE)


def _remove_dead_nodes(master: Master) -> None:
    master.remove_dead_nodes(["/a"])


def _set_parameters(master: Master) -> None:
    master.set_parameters({"/a": 1}, ["/b"])


def _read_signs(master: Master) -> None:
    with suppress(LookupError):
        look_up_nodes(["/a"], master)
    probe_node(master.uri)


def _listen(master: Master) -> None:
    with suppress(NoTopic):
        listen_to(master.uri, "/a", keep=8, timeout=_PATIENCE, caller="/b").close()


def _look_for_ready_nodes(master: Master) -> None:
    view = MasterView(master)
    with suppress(NoGraph):
        view.look(["/a", "/tf"])
        view.wait(0.01)
    view.forget()


def _read_lease(master: Master) -> None:
    read_lease(master.uri)


def _read_run_id(master: Master) -> None:
    master.get_run_id()


def _find_live_nodes(master: Master) -> None:
    with suppress(UserError):
        master.find_live_nodes(["/a"])


_QUESTIONS: tuple[Callable[[Master], None], ...] = (
    _draw_graph,
    _list_nodes,
    _remove_dead_nodes,
    _set_parameters,
    _read_signs,
    _listen,
    _look_for_ready_nodes,
    _read_lease,
    _read_run_id,
    _find_live_nodes,
)
TARGETS = (Target("xml_rpc", _ask, _WORDS),)
