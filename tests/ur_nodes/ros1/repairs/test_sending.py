from __future__ import annotations

import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from ur_nodes.ros1.repairs.sending import DirectConnection, wait_until_sent

LARGE = 100_000


class _Transport:
    """Takes what a connection sends; `socket` is one end of a pair for a subscriber of this computer."""

    def __init__(self, sock: socket.socket | None = None) -> None:
        self.socket = sock
        self.done = False
        self.sent: list[bytes] = []
        self.threads: set[threading.Thread] = set()
        self.free = threading.Event()
        self.free.set()
        self.callback: Callable[[Any], None] = lambda _: None

    def set_cleanup_callback(self, callback: Callable[[Any], None]) -> None:
        self.callback = callback

    def write_data(self, data: bytes) -> bool:
        self.free.wait(30)
        if self.socket is not None:
            self.socket.sendall(data)
        self.threads.add(threading.current_thread())
        self.sent.append(bytes(data[:1]))
        return True

    def close(self) -> None:
        self.done = True
        self.callback(self)


@pytest.fixture
def subscriber() -> Iterator[tuple[DirectConnection, socket.socket]]:
    ours, theirs = socket.socketpair()
    ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, LARGE)
    theirs.settimeout(30)
    transport: Any = _Transport(ours)
    with ours, theirs:
        yield DirectConnection(transport, 1), theirs
        transport.close()


def remote(queue_size: int = 1) -> tuple[DirectConnection, Any]:
    transport: Any = _Transport()
    return DirectConnection(transport, queue_size), transport


def receive(sock: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        data += sock.recv(size - len(data))
    return data


def until(reached: Callable[[], object]) -> None:
    deadline = time.monotonic() + 30
    while not reached():
        assert time.monotonic() < deadline
        time.sleep(0.001)


def test_message_is_sent_by_the_thread_that_publishes(subscriber: tuple[DirectConnection, socket.socket]) -> None:
    connection, sock = subscriber
    transport: Any = connection._connection
    for number in range(3):
        assert connection.write_data(b"m%d" % number)
        assert receive(sock, 2) == b"m%d" % number
    assert not transport.threads
    assert not connection.is_busy()


def test_slow_subscriber_gets_whole_messages_and_the_newest(
    subscriber: tuple[DirectConnection, socket.socket],
) -> None:
    connection, sock = subscriber
    letters = b"abcdefghij"
    for letter in letters:
        connection.write_data(bytes([letter]) * LARGE)
    assert connection.is_busy()
    received = [receive(sock, LARGE)]
    while received[-1][:1] != b"j":
        received.append(receive(sock, LARGE))
    assert [each for each in received if each != each[:1] * LARGE] == []
    order = b"".join(each[:1] for each in received)
    assert bytes(sorted(order)) == order
    assert order[:1] == b"a"
    assert len(order) < len(letters)
    until(lambda: not connection.is_busy())
    connection.write_data(b"after")
    assert receive(sock, 5) == b"after"


def test_no_message_that_was_sent_is_kept() -> None:
    connection, transport = remote()
    message = bytes(LARGE)
    alone = sys.getrefcount(message)
    connection.write_data(message)
    until(lambda: transport.sent and sys.getrefcount(message) == alone)
    transport.close()


def test_thread_sends_to_another_computer() -> None:
    connection, transport = remote()
    connection.write_data(b"drive")
    until(lambda: transport.sent)
    assert threading.current_thread() not in transport.threads
    transport.close()
    until(lambda: not any(each.is_alive() for each in transport.threads))


def test_oldest_messages_beyond_the_queue_are_dropped() -> None:
    connection, transport = remote(queue_size=2)
    transport.free.clear()
    connection.write_data(b"1")
    until(lambda: not connection._queue)  # its thread has taken it
    for letter in (b"2", b"3", b"4", b"5"):
        connection.write_data(letter)
    transport.free.set()
    until(lambda: not connection.is_busy())
    assert transport.sent == [b"1", b"4", b"5"]
    transport.close()


def test_error_of_a_message_is_raised_for_the_next_one(subscriber: tuple[DirectConnection, socket.socket]) -> None:
    connection, sock = subscriber
    sock.close()

    def fails() -> bool:
        try:
            connection.write_data(b"drive")
        except OSError:
            return True
        return False

    until(fails)


def test_last_messages_are_waited_for_until_they_are_sent() -> None:
    connection, transport = remote()
    transport.free.clear()
    connection.write_data(b"drive")
    until(lambda: not connection._queue)
    connection.write_data(b"stop")  # waits for the thread, which is busy
    wait_until_sent([connection], 0.01)
    assert connection.is_busy()
    threading.Timer(0.05, transport.free.set).start()
    wait_until_sent([connection], 30.0)
    assert transport.sent == [b"d", b"s"]
    transport.close()


def test_closed_connection_is_not_waited_for() -> None:
    connection, transport = remote()
    transport.free.clear()
    connection.write_data(b"drive")
    transport.close()
    wait_until_sent([connection], 30.0)
    transport.free.set()
