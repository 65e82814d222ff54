"""Origin of `joy`: its messages carry no proof of their age, so they must not have crossed a network."""

from __future__ import annotations

from functools import partial

from ur_nodes.ports.node import Location, Node

_AGAIN = 5.0  # s: then a publisher that could not be found is looked up again


class JoyOrigin:
    """Finds out which publishers run on this computer."""

    def __init__(self, node: Node, *, remote: bool) -> None:
        """`remote`: publishers on other computers are wanted."""
        self._node = node
        self._remote = remote
        self._accepted: set[str] = set()
        self._asked_at: dict[str, float] = {}

    def accepts(self, publisher: str) -> bool:
        """Return whether messages of this node may move the robot: not until it is known where the node runs."""
        if self._remote or publisher in self._accepted:
            return True
        now = self._node.steady()
        if now - self._asked_at.get(publisher, float("-inf")) >= _AGAIN:
            self._asked_at[publisher] = now
            self._node.work(partial(self._node.locate, publisher), partial(self._take, publisher), "origin")
        return False

    def _take(self, publisher: str, place: Location | None) -> None:
        if place is not None and place.here:
            self._accepted.add(publisher)
            return
        where = place.host if place else "an unknown computer"
        self._node.log.error(
            f"joy: {publisher} runs on {where}, expected it on this computer: what a network holds back would move the "
            "robot late; start this node where the joystick is, or set ~remote_joy"
        )
