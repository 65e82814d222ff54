"""Messages to subscribers: sent at once where the kernel takes them, without the thread that rospy has for each one.

rospy hands each message to a thread of its subscriber: two switches of threads for each message, and the thread keeps
the last one. Here the thread that publishes sends, as far as the kernel takes the message without waiting. Only what it
does not take goes to the thread, for which at most as many messages wait as the queue is long, as rospy has it.
"""

import socket
import time
from collections.abc import Iterable

import rospy.topics
from rospy.impl.tcpros_base import TCPROSTransport
from rospy.impl.tcpros_pubsub import QueuedConnection

from ur_nodes.ros1.repairs.sockets import is_remote

_POLL = 0.002  # s


class DirectConnection(QueuedConnection):
    """A connection to a subscriber, with a queue for what the kernel does not take.

    To another computer its thread sends everything: errors are noted there, as those of a network that was cut.
    """

    def __init__(self, connection: TCPROSTransport, queue_size: int) -> None:
        self._rest = b""  # of a message that was begun, which the queue may not drop
        self._relays = False  # the thread has taken messages
        self._direct = connection.socket is not None and not is_remote(connection.socket)
        super().__init__(connection, queue_size)

    def write_data(self, data: bytes) -> bool:
        """Send a message, or queue it. Raises the error of an earlier one."""
        with self._lock:
            if (error := self._error) is not None:
                self._error = None
                raise error
            sent = _send_some(self._connection, data) if self._direct and not self.is_busy() else 0
            if sent == len(data):
                return True
            if sent:
                self._rest = data[sent:]
            else:
                if len(self._queue) == self._queue_size > 0:
                    del self._queue[0]
                self._queue.append(data)
            self._cond_data_available.notify()
        return True

    def is_busy(self) -> bool:
        """Return whether messages wait, or are on their way."""
        return not self._connection.done and bool(self._relays or self._rest or self._queue)

    def _run(self) -> None:
        while self._relay():
            pass

    def _relay(self) -> bool:
        """Send what waits, and keep none of it; return False once the connection is closed."""
        with self._lock:
            self._relays = False
            while not (self._rest or self._queue or self._connection.done):
                self._cond_data_available.wait()
            messages = [self._rest, *self._queue] if self._rest else self._queue
            self._rest, self._queue, self._relays = b"", [], True
        for each in messages:
            if self._connection.done:
                return False
            try:
                self._connection.write_data(each)
            except Exception as problem:  # raised where the next message is published, as rospy does
                with self._lock:
                    self._error = problem
        return not self._connection.done


def send_at_once() -> None:
    """Make the connections of this process's publishers send in this way from now on. It fits rospy 1.15 to 1.17."""
    rospy.topics.QueuedConnection = DirectConnection  # type: ignore[attr-defined]


def wait_until_sent(connections: Iterable[object], seconds: float) -> None:
    """Wait at most `seconds` in all until connections have passed all messages to the system."""
    end = time.monotonic() + seconds
    for connection in connections:
        while isinstance(connection, DirectConnection) and connection.is_busy() and time.monotonic() < end:
            time.sleep(_POLL)


def _send_some(connection: TCPROSTransport, data: bytes) -> int:
    """Return how many bytes the kernel takes now; 0 for an error, which the thread meets again."""
    if connection.socket is None or connection.done:
        return 0
    try:
        return connection.socket.send(data, socket.MSG_DONTWAIT)
    except OSError:
        return 0
