"""The sockets between a node and the page's server."""

import json
import socket
from collections.abc import Iterator
from typing import Any

import pytest

from ur.web.wire.frames import LENGTH
from ur_nodes.memory.bus import Bus
from ur_nodes.web.server_link import Outlet, end_with_run, read_lines

Pair = tuple[socket.socket, socket.socket]


@pytest.fixture
def pair() -> Iterator[Pair]:
    ours, its = socket.socketpair()
    ours.settimeout(60.0)
    with ours, its:
        yield ours, its


def read(connection: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        data += connection.recv(size - len(data))
    return data


def test_lines_are_taken_in_order_on_the_thread_of_the_node_until_the_server_ends(pair: Pair) -> None:
    bus, got = Bus(), list[Any]()
    node = bus.node("web")
    ours, its = pair
    read_lines(node, {its: got.append})
    ours.sendall(b'{"a":1}\n{"a":')
    ours.sendall(b"2}\n")
    ours.shutdown(socket.SHUT_WR)
    while node.ended is None:  # the reader has a thread of its own
        bus.run(0.01)
    assert got == [{"a": 1}, {"a": 2}]
    assert node.ended == "the server has ended"
    assert not node.failed


def test_frames_arrive_whole_and_in_order_where_the_server_is_slow(pair: Pair) -> None:
    bus = Bus()
    ours, its = pair
    its.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    node = bus.node("web")
    jobs = hold_jobs(node)
    outlet = Outlet(node, its)
    outlet.send_line({"first": True})
    assert not outlet.busy
    frames = [bytes([number]) * 100_000 for number in range(3)]
    for frame in frames:
        outlet.send_frame(frame)
    assert outlet.busy
    line = json.dumps({"first": True}, separators=(",", ":")).encode() + b"\n"
    assert read(ours, len(line)) == line
    total = sum(LENGTH.size + len(each) for each in frames)
    got = bytearray()
    its.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 20)
    while len(got) < total:
        if jobs:
            jobs.pop(0)()
        got += ours.recv(total)
    assert bytes(got) == b"".join(LENGTH.pack(len(each)) + each for each in frames)
    assert not outlet.busy
    assert node.ended is None


def hold_jobs(node: Any) -> list[Any]:
    """Keep the jobs of a node until they are called."""
    jobs: list[Any] = []
    node.work = lambda job, take, _lane="": jobs.append(lambda: take(job()))
    return jobs


def test_node_ends_when_it_sends_to_a_server_that_has_ended(pair: Pair) -> None:
    node = Bus().node("web")
    pair[0].close()
    Outlet(node, pair[1]).send_line({})
    assert node.ended == "the server has ended"


def test_node_ends_with_a_server_that_reads_nothing(pair: Pair) -> None:
    node = Bus().node("web")
    hold_jobs(node)
    outlet = Outlet(node, pair[1])
    for _ in range(80):
        outlet.send_frame(bytes(1_000_000))
    assert node.ended == "the server reads nothing"


def test_node_ends_with_its_run() -> None:
    bus = Bus()
    bus.facts["run_id"] = "one"
    node = bus.node("web")
    end_with_run(node)
    bus.run(10.0)
    assert node.ended is None
    bus.facts["run_id"] = "two"
    bus.run(3.0)
    assert node.ended == "another master has started"
