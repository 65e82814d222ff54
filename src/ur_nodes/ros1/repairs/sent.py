"""Messages that were sent: rospy keeps the last one for each subscriber, and drops those that wait at its end."""

from __future__ import annotations

import time
from collections.abc import Iterable

from rospy.impl.tcpros_pubsub import QueuedConnection

DELAY = 2.0
"""s after which a message was sent, or is being sent, so that `free_sent` can free it."""

_POLL = 0.002  # s


def free_sent(connections: Iterable[object]) -> None:
    """Release the last message of idle connections: let them send no bytes, which they remember instead."""
    for connection in connections:
        if not isinstance(connection, QueuedConnection):
            continue  # rospy sends without a queue, and keeps nothing
        with connection._cond_data_available:  # noqa: SLF001 - there is no other way
            if not connection._queue:  # noqa: SLF001 - else a message waits, and takes the place of the last one
                connection._queue.append(b"")  # noqa: SLF001
                connection._cond_data_available.notify()  # noqa: SLF001


def wait_until_sent(connections: Iterable[object], seconds: float) -> None:
    """Wait at most `seconds` in all until connections have passed all messages to the system."""
    end = time.monotonic() + seconds
    for connection in connections:
        while _is_busy(connection) and time.monotonic() < end:
            time.sleep(_POLL)


def _is_busy(connection: object) -> bool:
    """Return whether messages wait, or its thread, which waits for messages otherwise, is sending one."""
    if not isinstance(connection, QueuedConnection) or connection.done:
        return False
    with connection._cond_data_available:  # noqa: SLF001
        idle = bool(connection._cond_data_available._waiters)  # type: ignore[attr-defined] # noqa: SLF001
        return bool(connection._queue) or not idle  # noqa: SLF001
