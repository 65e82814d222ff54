"""A node of ROS 1."""

from __future__ import annotations

import contextlib
import queue
import time
from collections.abc import Callable
from functools import partial
from http.client import HTTPException
from typing import Any, TypeVar
from urllib.parse import urlsplit
from xml.parsers.expat import ExpatError
from xmlrpc.client import Error as XmlRpcError

import rosgraph
import rosgraph.network
import rospy

from ur_nodes.codecs import find_codec
from ur_nodes.loop import Beat, Loop, Worker
from ur_nodes.ports.actions import GoalClient, GoalFollower, GoalTakers
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Location, Sender
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.transforms import Transforms
from ur_nodes.ports.values import Result
from ur_nodes.ros1.facts import RosFacts, RosLog, RosParameters
from ur_nodes.ros1.repairs.sent import DELAY, wait_until_taken
from ur_nodes.ros1.services import call_service, serve_service
from ur_nodes.ros1.topics import RosPublisher, RosSubscription, sender_of

Value = TypeVar("Value")

_MOST_TRANSFORMS = 1000  # messages that wait while a callback takes long: a history with gaps is of no use
_END_LIMIT = 3.0  # s, besides the time that the jobs of the end have
_TAKEN_LIMIT = 0.5  # s: for threads of a busy computer to take what was sent last
_LEAVE = 0.03  # s: and for it to leave


class RosNode:
    """See `ports.node.Node`. Made after rospy.init_node; `begin` starts its thread."""

    def __init__(self) -> None:
        self.name: str = rospy.get_name()
        self.facts = RosFacts()
        self.parameters = Parameters(RosParameters())
        self.log = RosLog()
        self.failed = False
        self._transforms: Transforms | None = None
        self._loop = Loop(
            rospy.get_time if self.facts.simulated_time else time.monotonic, steady=not self.facts.simulated_time
        )
        self._workers: dict[str, Worker] = {}
        self._at_end: list[Callable[[], None]] = []
        self._ending = False
        self._end_limit = 0.0  # s for the jobs of the end
        self._unfinished = 0  # of these
        self._results: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()  # of these
        rospy.on_shutdown(lambda: self._loop.end(self._finish, _END_LIMIT + self._end_limit))

    def begin(self, on_failure: Callable[[], None] = lambda: None) -> None:
        """Let callbacks come. `on_failure` is called when one of them has failed, after which there are no more."""
        self._loop.start(on_failure)

    def ask(self, call: Callable[[], None]) -> None:
        """Have a call made on the node's thread: for code that has threads of its own, once the node has begun."""
        self._loop.ask(call)

    @property
    def transforms(self) -> Transforms:
        """See Node."""
        if self._transforms is None:
            from ur_nodes.ros1.transforms import TransformTopics

            topics = TransformTopics()
            self._transforms = tree = Transforms(topics.send)
            topics.listen(self._loop.mailbox(_MOST_TRANSFORMS, tree.take), self._loop.mailbox(None, tree.take))
        return self._transforms

    @property
    def raw(self) -> Any:
        """See Node."""
        from ur_nodes.ros1.raw import RosRaw

        return RosRaw(self._loop)

    def publish(
        self,
        topic: str,
        kind: type[Value],
        quality: Quality = Quality.NEWEST,
        greet: Callable[[], Value | None] | None = None,
    ) -> RosPublisher:
        """See Node."""
        publisher = RosPublisher(topic, find_codec(kind), quality)
        if quality is Quality.LATCHED:

            def free() -> None:
                self._loop.after(DELAY, publisher.free_sent, steady=True)

            publisher.watch(lambda: self._loop.post(free))
        if greet is not None:

            def answer() -> None:
                if (value := greet()) is not None:
                    publisher.send(value)

            publisher.watch(lambda: self._loop.post(answer))
        return publisher

    def subscribe(
        self,
        topic: str,
        kind: type[Value],
        take: Callable[[Value], None],
        quality: Quality = Quality.NEWEST,
        unreadable: Callable[[str], None] | None = None,
    ) -> RosSubscription:
        """See Node."""
        codec = find_codec(kind)
        return RosSubscription(
            topic, codec, quality, self._loop, lambda value, _message: take(value), unreadable=unreadable
        )

    def subscribe_from(
        self,
        topic: str,
        kind: type[Value],
        take: Callable[[Value, Sender | None], None],
        quality: Quality = Quality.NEWEST,
    ) -> RosSubscription:
        """See Node."""
        return RosSubscription(
            topic, find_codec(kind), quality, self._loop, lambda value, message: take(value, sender_of(message))
        )

    def subscribe_fields(
        self, topic: str, type_name: str, fields: tuple[str, ...], take: Callable[[tuple[Any, ...]], None]
    ) -> RosSubscription:
        """See Node."""
        from ur_nodes.codecs.foreign import find_foreign

        codec = find_foreign(type_name, fields)
        return RosSubscription(topic, codec, Quality.EVERY, self._loop, lambda value, _message: take(value))

    def serve(self, service: str, kind: type[Value], answer: Callable[[Value], Result]) -> None:
        """See Node."""
        self.serve_later(service, kind, lambda request, give: give(answer(request)))

    def serve_later(
        self, service: str, kind: type[Value], take: Callable[[Value, Callable[[Result], None]], None]
    ) -> None:
        """See Node."""
        serve_service(self._loop, service, kind, take)

    def call(self, service: str, request: object, take: Callable[[Result], None], within: float = 5.0) -> None:
        """See Node."""
        call_service(self._loop, service, request, take, within)

    def serve_goals(self, action: str, takers: GoalTakers, kept: float = 5.0) -> Any:
        """See Node."""
        from ur_nodes.ros1.goals import RosGoalServer

        return RosGoalServer(action, takers, self._loop, kept)

    def follow_goals(self, action: str, follower: GoalFollower) -> GoalClient:
        """See Node."""
        from ur_nodes.ros1.goal_client import RosGoalClient

        return RosGoalClient(action, follower, self._loop)

    def every(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> Beat:
        """See Node."""
        return self._loop.every(seconds, call, steady=steady)

    def after(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> Beat:
        """See Node."""
        return self._loop.after(seconds, call, steady=steady)

    def work(self, job: Callable[[], Value], take: Callable[[Value], None], lane: str = "") -> None:
        """See Node."""
        self._unfinished += self._ending
        post = self._results.put if self._ending else self._loop.post

        def carry_out() -> None:
            try:
                result = job()
            except Exception as problem:  # the node fails where it runs: the jobs of its end can still be done
                post(partial(_fail, problem))
            else:
                post(lambda: take(result))

        self._workers.setdefault(lane, Worker(f"work {lane}".strip())).add(carry_out)

    def post(self, call: Callable[[], None]) -> None:
        """See Node."""
        self._loop.post(call)

    def now(self) -> int:
        """See Node."""
        return int(rospy.Time.now().to_nsec())

    def steady(self) -> float:
        """See Node."""
        return time.clock_gettime(time.CLOCK_BOOTTIME)

    def read_graph(self, take: Callable[[Graph | None], None]) -> None:
        """See Node."""
        from ur_nodes.ros1.graph import read_graph

        self.work(lambda: read_graph(self.name), take, "graph")

    def locate(self, name: str) -> Location | None:
        """See Node."""
        try:
            host = urlsplit(rosgraph.Master(self.name).lookupNode(name)).hostname
        except (OSError, ValueError, rosgraph.MasterException, HTTPException, XmlRpcError, ExpatError):
            return None
        return Location(host, rosgraph.network.is_local_address(host)) if host else None

    def resolve(self, name: str) -> str:
        """See Node."""
        return str(rospy.resolve_name(name))

    def on_end(self, call: Callable[[], None], within: float = 2.0) -> None:
        """See Node."""
        self._at_end.append(call)
        self._end_limit = max(self._end_limit, within)

    def end(self, reason: str, *, failed: bool = False) -> None:
        """See Node."""
        self.failed = self.failed or failed
        rospy.signal_shutdown(reason)

    def _finish(self) -> None:
        for worker in self._workers.values():
            worker.drop()
        self._ending = True
        for call in self._at_end:
            self._attempt(call)
        end = time.monotonic() + self._end_limit
        with contextlib.suppress(queue.Empty):
            while self._unfinished:
                take = self._results.get(timeout=max(0.0, end - time.monotonic()))
                self._unfinished -= 1
                self._attempt(take)
        if self._at_end:
            publishers = tuple(rospy.topics.get_topic_manager().pubs.values())
            wait_until_taken((each for one in publishers for each in tuple(one.connections)), _TAKEN_LIMIT)
            time.sleep(_LEAVE)

    def _attempt(self, call: Callable[[], None]) -> None:
        """Make a call of the end; where it fails, the others are made all the same."""
        try:
            call()
        except Exception as problem:
            self.failed = True
            rospy.logerr("%r", problem)


def _fail(problem: Exception) -> None:
    raise problem
