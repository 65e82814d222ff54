"""Velocities of a client, sent until they are ended, and at most for the time that was requested."""

from collections.abc import Callable

from ur_nodes.motion.challenge.link import FreshPublisher
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.ports.node import Node, Timer
from ur_nodes.ports.values import Twist

STILL = Twist(0.0, 0.0)


class VelocityCommands:
    """Answers challenges of the mux with the requested velocity. Works on the node's thread, except `renew`.

    The thread that asked for the velocity answers each challenge itself, by `renew`: the age of a command is also that
    of the thread's last sign of life, so a program that hangs drives no longer than one that is killed. A velocity
    whose thread `hangs` ends.
    """

    def __init__(self, node: Node, topic: str, hangs: Callable[[], bool]) -> None:
        """`topic` is the one of plain velocities; the stamped ones are beside it."""
        self._node, self._topic, self._hangs = node, topic, hangs
        self.hung = False
        """True when the newest velocity has ended early, because the thread hung."""
        self._twist: Twist | None = None
        self._end: Timer | None = None
        self._answered: int | None = None

    def connect(self, lease: LeaseClient) -> None:
        """Send as a client of this lease."""
        self._lease = lease
        self._publisher = FreshPublisher(self._topic, lease.link, lease.client)

    def subscribers(self) -> int:
        """Return the number of subscribers of the velocities."""
        return self._publisher.subscribers()

    @property
    def on(self) -> bool:
        """Return whether a velocity is being sent."""
        return self._twist is not None

    def begin(self, twist: Twist, seconds: float) -> None:
        """Drive at a velocity for `seconds`; it replaces the last one."""
        self.end(stop=False)
        if not self._lease.view().mine:
            self._lease.acquire()
        self._twist, self.hung = twist, False
        self._end = self._node.after(seconds, self.end, steady=True)
        self._answer()

    def end(self, *, stop: bool = True) -> None:
        """End the velocity; with `stop` send zero at once if this client drives."""
        if self._end is not None:
            self._end.cancel()
        if stop and self._twist is not None and self._lease.view().mine:
            self._publisher.send(STILL)
        self._twist = self._end = None

    def renew(self) -> None:
        """Answer the newest challenge. Called repeatedly by the thread that requested the velocity."""
        newest = self._lease.link.newest()
        if self._twist is not None and newest is not None and newest != self._answered:
            self._answered = newest
            self._node.post(self._answer)

    def check(self) -> None:
        """End the velocity of a thread that hangs; called when a challenge has arrived."""
        if self._twist is not None and self._hangs():
            self.hung = True
            self.end()

    def _answer(self) -> None:
        if self._twist is not None and not self._lease.view().other:
            self._publisher.send(self._twist)
