from __future__ import annotations

import sys
import threading
import time

from rospy.impl.tcpros_pubsub import QueuedConnection

from ur_nodes.ros1.repairs.sent import free_sent


class _Transport:
    """Takes what a connection sends; the connection's own queue and thread are rospy's."""

    def __init__(self) -> None:
        self.done = False
        self.sent = 0
        self.all_sent = threading.Event()

    def set_cleanup_callback(self, callback: object) -> None:
        self.callback = callback

    def write_data(self, data: bytes) -> None:
        self.sent += len(data)
        if not data:
            self.all_sent.set()


def test_connection_keeps_no_message_that_was_sent() -> None:
    transport = _Transport()
    connection = QueuedConnection(transport, 0)
    try:
        message = bytes(100_000)
        alone = sys.getrefcount(message)
        connection.write_data(message)
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


def test_closed_connection_is_left_alone() -> None:
    class Closed:
        def write_data(self, data: bytes) -> None:
            raise OSError(f"closed, {len(data)} bytes")

    free_sent([Closed()])
