"""The protocol between a node and its backend: topics, services, goals, time, parameters and the end.

All callbacks of a node run one after the other, on one thread that the backend owns; nothing of a node needs a lock.
A callback must not wait: long work goes to `work`, which posts its result back. An exception in a callback ends the
node. Names are those of ROS: 'scan' below the namespace, '~goal' below the node, '/tf' as it is; all can be remapped.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeVar

from ur_nodes.ports.actions import GoalClient, GoalFollower, GoalHandlers, GoalServer
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


class Facts(Protocol):
    """Reads and writes facts, by names such as 'base_name'."""

    simulated_time: bool
    """True where the time of `Node.now` is a simulation's."""

    def get(self, name: str, default: object = None) -> object:
        """Return the value of a fact; `default` while it is unknown."""

    def set(self, name: str, value: object) -> None:
        """Publish a fact to all nodes."""


Value = TypeVar("Value")

SECOND = 1_000_000_000
"""ns"""


@dataclass(frozen=True, slots=True)
class Location:
    """The computer that a node runs on, and whether it is this one."""

    host: str
    here: bool


class Node(Protocol):
    """A node's backend. See the module for threads and names."""

    name: str
    parameters: Parameters

    @property
    def facts(self) -> Facts:
        """Return the facts of the run."""

    @property
    def log(self) -> Log:
        """Return the log."""

    @property
    def transforms(self) -> Transforms:
        """Return the transform tree, which subscribes on first use."""

    @property
    def raw(self) -> Raw:
        """Return the access to messages of any type, for tools."""

    def publish(
        self,
        topic: str,
        kind: type[Value],
        quality: Quality = Quality.NEWEST,
        on_subscriber: Callable[[], Value | None] | None = None,
    ) -> Publisher[Value]:
        """Publish on a topic. For each new subscriber `on_subscriber` returns a value that all subscribers then get."""

    def subscribe(
        self,
        topic: str,
        kind: type[Value],
        callback: Callable[[Value], None],
        quality: Quality = Quality.NEWEST,
        unreadable: Callable[[str], None] | None = None,
    ) -> Subscription:
        """Subscribe to a topic. A message that is no `kind` is dropped; `unreadable`, or the log, gets the reason."""

    def subscribe_from(
        self,
        topic: str,
        kind: type[Value],
        callback: Callable[[Value, Sender | None], None],
        quality: Quality = Quality.NEWEST,
    ) -> Subscription:
        """Subscribe, and get the sender of each value; None if the middleware does not know it."""

    def subscribe_fields(
        self, topic: str, type_name: str, fields: tuple[str, ...], callback: Callable[[tuple[object, ...]], None]
    ) -> Subscription:
        """Subscribe to messages of any type by its name in the middleware; `callback` gets the fields.

        Raises LookupError if the type is not installed, ValueError if it has no such fields.
        """

    def serve(self, service: str, kind: type[Value], answer: Callable[[Value], Result]) -> None:
        """Serve requests of a kind, see `ports.services`. Without their messages no service is offered."""

    def serve_later(
        self, service: str, kind: type[Value], callback: Callable[[Value, Callable[[Result], None]], None]
    ) -> None:
        """Serve requests whose answer needs work: `callback` gets a request, and a function to call with the answer."""

    def call(self, service: str, request: object, callback: Callable[[Result], None], within: float = 5.0) -> None:
        """Call a service; `callback` gets the answer, or a result without success after `within` s.

        Calls do not wait for one another, and may be answered in another order.
        """

    def serve_goals(self, action: str, handlers: GoalHandlers, kept: float = 5.0) -> GoalServer:
        """Serve an action that drives to a pose. States of goals are sent for `kept` s after their end."""

    def follow_goals(self, action: str, follower: GoalFollower) -> GoalClient:
        """Send goals of an action, and receive the states of all goals."""

    def every(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> Timer:
        """Call periodically, in the time of `now`, or of `steady`. A call late by more than a period is left out."""

    def after(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> Timer:
        """Call once after a number of seconds of `now`, or of `steady`."""

    def work(self, job: Callable[[], Value], callback: Callable[[Value], None], queue: str = "") -> None:
        """Run a job on a worker; `callback` gets its result on the node's thread.

        Jobs of a lane run one after the other, lanes in parallel. Jobs that wait at the end of the node are dropped;
        jobs that `on_end` starts, and that their results start, are still done.
        """

    def post(self, call: Callable[[], None]) -> None:
        """Call on the node's thread, after earlier posted calls. After the end nothing happens.

        This is the only method for other threads, such as those of a user interface, a device or a socket.
        """

    def now(self) -> int:
        """Return the time of all nodes in ns, which is simulated time in a simulation."""

    def steady(self) -> float:
        """Return the seconds of a clock that is never set and continues while the computer is suspended."""

    def read_graph(self, callback: Callable[[Graph | None], None]) -> None:
        """Read the present nodes, topics and services; `callback` gets None without an answer."""

    def subscribed_kinds(self, topic: str, kinds: tuple[type, ...]) -> frozenset[type] | None:
        """Return those of the kinds to which other nodes subscribe on a topic now; None if that is unknown."""

    def kinds_sent(self, topic: str, kinds: tuple[type, ...]) -> frozenset[type] | None:
        """Return those of the kinds that other nodes publish on a topic now; None if that is unknown."""

    def locate(self, name: str) -> Location | None:
        """Return the computer of a node; None if unknown. It may block: call it from `work`."""

    def resolve(self, name: str) -> str:
        """Resolve a name of this node to its full name."""

    def hold_messages(self, hold: bool) -> None:
        """Let messages that arrive wait, if the middleware can, for the next timer, which has to be due soon."""

    def on_end(self, call: Callable[[], None], within: float = 2.0) -> None:
        """Call when the node ends, before its topics close; values sent then are still delivered.

        The node waits at most `within` s for jobs that the call starts.
        """

    def end(self, reason: str, *, failed: bool = False) -> None:
        """End the node."""


class Timer(Protocol):
    """A call that is repeated, or scheduled for later."""

    def cancel(self) -> None:
        """Cancel the call."""
