"""Origin of `joy`: its messages carry no proof of their age, so they must not have crossed a network."""

from __future__ import annotations

import contextlib
import time
from urllib.parse import urlsplit

import rosgraph
import rosgraph.network
import rospy

_AGAIN = 5.0  # s: then a publisher that could not be found is looked up again


class JoyOrigin:
    """Finds out which publishers run on this computer."""

    def __init__(self, *, remote: bool) -> None:
        """`remote`: publishers on other computers are wanted."""
        self._remote = remote
        self._accepted: dict[str, bool] = {}
        self._checked_at: dict[str, float] = {}

    def accepts(self, publisher: str) -> bool:
        """Return whether messages of this node may move the robot. Asks the master until the node is accepted."""
        if self._remote:
            return True
        accepted = self._accepted.get(publisher, False)
        if not accepted and time.monotonic() - self._checked_at.get(publisher, float("-inf")) >= _AGAIN:
            accepted = self._accepted[publisher] = self._check(publisher)
            self._checked_at[publisher] = time.monotonic()
        return accepted

    def _check(self, publisher: str) -> bool:
        host = None
        with contextlib.suppress(OSError, rosgraph.MasterException):
            uri = rosgraph.Master(rospy.get_name()).lookupNode(publisher)
            host = urlsplit(uri).hostname
        if host is not None and rosgraph.network.is_local_address(host):
            return True
        rospy.logerr(
            "joy: %s runs on %s, expected it on this computer: what a network holds back would move the robot late; "
            "start this node where the joystick is, or set ~remote_joy",
            publisher,
            host or "an unknown computer",
        )
        return False
