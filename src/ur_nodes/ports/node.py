"""The protocol of a node's surroundings: topics, services, goals, time, parameters and the end.

All callbacks of a node run one after the other, on one thread that the backend owns; nothing of a node needs a lock.
A callback must not wait: long work goes to `work`, which posts its result back. An exception in a callback ends the
node. Names are those of ROS: 'scan' below the namespace, '~goal' below the node, '/tf' as it is; all can be remapped.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeVar

from ur_nodes.ports.actions import GoalClient, GoalFollower, GoalServer, GoalTakers
from ur_nodes.ports.facts import Facts
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.log import Log
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import Raw
from ur_nodes.ports.topics import Publisher as Publisher
from ur_nodes.ports.topics import Sender as Sender
from ur_nodes.ports.topics import Subscription as Subscription
from ur_nodes.ports.transforms import Transforms
from ur_nodes.ports.values import Result

Value = TypeVar("Value")

SECOND = 1_000_000_000
"""ns"""


@dataclass(frozen=True, slots=True)
class Location:
    """The computer that a node runs on, and whether it is this one."""

    host: str
    here: bool


class Node(Protocol):
    """A node's surroundings. See the module for threads and names."""

    name: str
    parameters: Parameters

    @property
    def facts(self) -> Facts:
        """The facts of the run."""

    @property
    def log(self) -> Log:
        """The log."""

    @property
    def transforms(self) -> Transforms:
        """The transform tree; it listens from the first use on."""

    @property
    def raw(self) -> Raw:
        """Messages of any type, for tools."""

    def publish(
        self,
        topic: str,
        kind: type[Value],
        quality: Quality = Quality.NEWEST,
        greet: Callable[[], Value | None] | None = None,
    ) -> Publisher[Value]:
        """Offer a topic. `greet` is asked, when a node begins to listen, for what all listeners then get."""

    def subscribe(
        self,
        topic: str,
        kind: type[Value],
        take: Callable[[Value], None],
        quality: Quality = Quality.NEWEST,
        unreadable: Callable[[str], None] | None = None,
    ) -> Subscription:
        """Listen to a topic. What cannot be a `kind` is reported once and dropped, or `unreadable` gets the reason."""

    def subscribe_from(
        self,
        topic: str,
        kind: type[Value],
        take: Callable[[Value, Sender | None], None],
        quality: Quality = Quality.NEWEST,
    ) -> Subscription:
        """Listen, with the sender of each value; None where the middleware does not know it."""

    def subscribe_fields(
        self, topic: str, type_name: str, fields: tuple[str, ...], take: Callable[[tuple[object, ...]], None]
    ) -> Subscription:
        """Listen to messages that are of no kind, by the middleware's name of their type; `take` gets the fields.

        Raises LookupError: the type is not installed; ValueError: it has no such fields.
        """

    def serve(self, service: str, kind: type[Value], answer: Callable[[Value], Result]) -> None:
        """Answer requests of a kind, see `ports.services`. Nothing is offered where their messages are missing."""

    def serve_later(
        self, service: str, kind: type[Value], take: Callable[[Value, Callable[[Result], None]], None]
    ) -> None:
        """As `serve`, where an answer needs work: `take` gets the request, and what to call with the answer, once."""

    def call(self, service: str, request: object, take: Callable[[Result], None], within: float = 5.0) -> None:
        """Ask a service; `take` gets the answer, or a result without success after `within` s.

        Calls do not wait for each other, and may overtake.
        """

    def serve_goals(self, action: str, takers: GoalTakers, kept: float = 5.0) -> GoalServer:
        """Take goals of an action that drives to a pose. Their states are sent for `kept` s after their end."""

    def follow_goals(self, action: str, follower: GoalFollower) -> GoalClient:
        """Send goals of an action, and follow all of them."""

    def every(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> Timer:
        """Call again and again, in the time of `now`, or of `steady`. A beat late by more than one is left out."""

    def after(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> Timer:
        """Call once, in so many seconds of `now`, or of `steady`."""

    def work(self, job: Callable[[], Value], take: Callable[[Value], None], lane: str = "") -> None:
        """Run a job beside the node, and take its result as any other callback.

        Jobs of a lane run one after the other, lanes side by side. Those that wait at the end of the node are dropped;
        those that `on_end` asks for, and that their results ask for, are still done.
        """

    def post(self, call: Callable[[], None]) -> None:
        """Make a call on the node's thread, after those that were posted before. After the end nothing happens.

        The one method that other threads may use: of a user interface, a reader of a device, a socket.
        """

    def now(self) -> int:
        """The time of all nodes in ns: simulated where they are."""

    def steady(self) -> float:
        """Seconds of a clock that is never set and that runs on while the computer sleeps."""

    def read_graph(self, take: Callable[[Graph | None], None]) -> None:
        """Ask for the nodes, topics and services of now; `take` gets None where there is no answer."""

    def kinds_taken(self, topic: str, kinds: tuple[type, ...]) -> frozenset[type] | None:
        """Those of the kinds that other nodes subscribe to on a topic now; None where that is unknown."""

    def kinds_sent(self, topic: str, kinds: tuple[type, ...]) -> frozenset[type] | None:
        """Likewise, those that other nodes publish on a topic."""

    def locate(self, name: str) -> Location | None:
        """Find out where a node runs; None: it is not known. It may wait: for `work`."""

    def resolve(self, name: str) -> str:
        """The full name of a name of this node."""

    def on_end(self, call: Callable[[], None], within: float = 2.0) -> None:
        """Call when the node ends, before its topics close; what it sends then still leaves.

        The node waits for the jobs that it asks for, at most `within` s.
        """

    def end(self, reason: str, *, failed: bool = False) -> None:
        """End the node."""


class Timer(Protocol):
    """A call that is repeated, or made later."""

    def cancel(self) -> None:
        """Call no more."""
