from __future__ import annotations

import sys
import threading
import time

from rospy.impl.tcpros_pubsub import QueuedConnection

from ur_nodes.ros1.repairs.sent import free_sent, wait_until_sent


class _Transport:
    """Takes what a connection sends; the connection's own queue and thread are rospy's."""

    def __init__(self) -> None:
        self.done = False
        self.sent = 0
        self.all_sent = threading.Event()
        self.free = threading.Event()
        self.free.set()

    def set_cleanup_callback(self, callback: object) -> None:
        self.callback = callback

    def write_data(self, data: bytes) -> None:
        self.free.wait(30)
        self.sent += len(data)
        if not data:
            self.all_sent.set()


def test_connection_keeps_no_message_that_was_sent() -> None:
    transport = _Transport()
    connection = QueuedConnection(transport, 1)
    try:
        message = bytes(100_000)
        alone = sys.getrefcount(message)
        connection.write_data(message)
        while connection._queue:
            time.sleep(0.001)
        free_sent([connection])
        assert transport.all_sent.wait(30)
        deadline = time.monotonic() + 30
        while sys.getrefcount(message) > alone and time.monotonic() < deadline:
            time.sleep(0.001)
        assert sys.getrefcount(message) == alone
        assert transport.sent == len(message)
    finally:
        transport.done = True
        connection._closed_connection_callback(transport)


def test_message_that_waits_is_sent() -> None:
    transport = _Transport()
    connection = QueuedConnection(transport, 1)
    try:
        transport.free.clear()
        for message in (b"first", b"second"):
            connection.write_data(message)
            while message == b"first" and connection._queue:
                time.sleep(0.001)
        free_sent([connection])
        transport.free.set()
        while transport.sent < len(b"firstsecond"):
            time.sleep(0.001)
    finally:
        transport.done = True
        connection._closed_connection_callback(transport)


def test_connection_without_a_queue_keeps_nothing_and_is_left_alone() -> None:
    transport = _Transport()
    free_sent([transport])
    assert not transport.all_sent.is_set()


def test_last_messages_are_waited_for_until_they_are_sent() -> None:
    transport = _Transport()
    connection = QueuedConnection(transport, 1)
    try:
        transport.free.clear()
        connection.write_data(b"drive")
        while connection._queue:
            time.sleep(0.001)
        connection.write_data(b"stop")  # waits for the thread, which is busy
        wait_until_sent([connection], 0.01)
        assert connection._queue
        threading.Timer(0.05, transport.free.set).start()
        wait_until_sent([connection], 30.0)
        assert transport.sent == len(b"drivestop")
    finally:
        transport.free.set()
        transport.done = True
        connection._closed_connection_callback(transport)
