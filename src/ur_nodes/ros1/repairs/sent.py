"""Memory of large messages that were sent: rospy keeps the last one for each subscriber until it sends another."""

from __future__ import annotations

import threading
from collections.abc import Iterable
from contextlib import suppress
from typing import Any

import rospy

_DELAY = 2.0  # s; by then the message is being sent or was


class SentMessages(rospy.SubscribeListener):  # type: ignore[misc]  # rospy has no types
    """Frees what a latched topic has sent to a new subscriber. The topic's queue must be without limit (0)."""

    def __init__(self) -> None:
        super().__init__()
        self.publisher: Any = None

    def peer_subscribe(self, *_: object) -> None:
        """See rospy.SubscribeListener."""
        timer = threading.Timer(_DELAY, self._free)
        timer.daemon = True
        timer.start()

    def _free(self) -> None:
        implementation = getattr(self.publisher, "impl", None)
        if implementation is not None:
            free_sent(tuple(implementation.connections))


def free_sent(connections: Iterable[Any]) -> None:
    """Have connections of a publisher send no bytes, which they remember instead of what they sent before."""
    for connection in connections:
        with suppress(Exception):  # it was closed; rospy notices
            connection.write_data(b"")
