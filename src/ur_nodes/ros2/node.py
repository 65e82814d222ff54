"""A node of ROS 2."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, TypeVar

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Clock, Node, TopicEndpointInfo
from rclpy.utilities import get_rmw_implementation_identifier

from ur_nodes.codecs import KindCodec, find_codec
from ur_nodes.file_facts import FileFacts
from ur_nodes.loop import Loop
from ur_nodes.node_base import LoopNode
from ur_nodes.ports.actions import GoalClient, GoalFollower, GoalHandlers, GoalServer
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.log import ThrottledLog
from ur_nodes.ports.node import Location, Sender
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import Raw
from ur_nodes.ports.transforms import Transforms
from ur_nodes.ports.values import Result
from ur_nodes.ros2.names import resolve, type_name_of
from ur_nodes.ros2.parameters import RosParameters
from ur_nodes.ros2.reception import ReceivingNode
from ur_nodes.ros2.services import NodeServices, TransformTopics
from ur_nodes.ros2.topics import RosPublisher, RosSubscription

if TYPE_CHECKING:
    from lifecycle_msgs.srv import GetState
    from rclpy.clock import JumpHandle
    from std_srvs.srv import Trigger

    from ur_nodes.ros2.navigation.server import NavigationActions

STANDS_IN: Final = {
    "amcl": ("amcl",),
    "map_server": ("map_server",),
    "move_base": ("bt_navigator", "controller_server", "planner_server"),
    "slam_gmapping": ("slam_toolbox",),
}
"""Nodes of ours by name, and the managed nodes whose tasks they have."""

MANAGERS: Final = {"amcl": "lifecycle_manager_localization", "move_base": "lifecycle_manager_navigation"}
"""The nodes that manage these."""


def answer_for_managed_nodes(node: Node) -> None:
    """Offer the services of the managed node that this one replaces; nothing for other nodes."""
    name = node.get_name()
    if name in STANDS_IN:
        from lifecycle_msgs.srv import GetState

        for managed in STANDS_IN[name]:
            node.create_service(GetState, f"{managed}/get_state", _answer_state)
    if name in MANAGERS:
        from std_srvs.srv import Trigger

        node.create_service(Trigger, f"{MANAGERS[name]}/is_active", _answer_active)


def _answer_state(_request: GetState.Request, response: GetState.Response) -> GetState.Response:
    from lifecycle_msgs.msg import State

    response.current_state = State(id=State.PRIMARY_STATE_ACTIVE, label="active")
    return response


def _answer_active(_request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
    response.success = True
    return response


Value = TypeVar("Value")

_MOST_TRANSFORMS = 1000  # messages that wait while a callback takes long: a history with gaps is of no use
_END_LIMIT = 3.0  # s for the executor to end
_LEAVE = 0.05  # s: for what was sent last to leave


class RosNode(LoopNode):
    """See `ports.node.Node`. Made after rclpy.init; `begin` starts its threads."""

    def __init__(self, name: str) -> None:
        self._node = ReceivingNode(name)
        self.name = self._node.get_fully_qualified_name()
        self._stored = RosParameters(self._node)
        self.facts = FileFacts(simulated_time=self._node.get_parameter("use_sim_time").value is True)
        self.replaced = False  # ROS 2 lets nodes share a name
        self.ended: Callable[[str], None] = lambda _reason: None
        self.leaving: Callable[[], None] = lambda: None  # called before the node leaves the graph
        self._simulated = self.facts.simulated_time
        self._clock = self._node.get_clock()
        self._transforms: Transforms | None = None
        read = self._seconds if self._simulated else time.monotonic
        loop = Loop(read, steady=not self._simulated, calls=self._node.reception)
        logger = self._node.get_logger()
        log = ThrottledLog(logger.debug, logger.info, logger.warning, logger.error, self._seconds)
        super().__init__(loop, log, Parameters(self._stored))
        self._executor = SingleThreadedExecutor(context=self._node.context)
        self._executor.add_node(self._node)
        self._spinner = threading.Thread(target=self._executor.spin, name="executor", daemon=True)
        self._services = NodeServices(self._node, self._executor, loop, self.log)
        self._actions: NavigationActions | None = None
        self._following = _follow_clock(self._clock, loop.passed) if self._simulated else None
        answer_for_managed_nodes(self._node)

    def begin(self, on_failure: Callable[[], None] = lambda: None) -> None:
        """Start callbacks. `on_failure` is called after one of them has failed, after which there are no more."""
        self._stored.serve(self.parameters, self.change)
        self._loop.start(on_failure)
        self._spinner.start()

    def close(self) -> None:
        """Run the calls of `on_end`, and leave the graph."""
        self.finish(lambda: time.sleep(_LEAVE))
        self._executor.shutdown(_END_LIMIT)
        if self._spinner.is_alive():
            self._spinner.join(_END_LIMIT)
        self.leaving()
        if self._actions is not None:
            self._actions.close()
        self._node.destroy_node()
        self._node.reception.close()

    def hold_messages(self, hold: bool) -> None:
        """See Node. Not where messages are the clock, or without their times of arrival."""
        dated = hold and get_rmw_implementation_identifier().startswith("rmw_fastrtps")
        self._node.reception.holds = dated and not self._simulated

    @property
    def transforms(self) -> Transforms:
        if self._transforms is None:
            topics = TransformTopics(self._node)
            self._transforms = tree = Transforms(topics.send, self.log)
            topics.listen(self._loop.mailbox(_MOST_TRANSFORMS, tree.receive), self._loop.mailbox(None, tree.receive))
        return self._transforms

    def publish(
        self,
        topic: str,
        kind: type[Value],
        quality: Quality = Quality.NEWEST,
        on_subscriber: Callable[[], Value | None] | None = None,
    ) -> RosPublisher[Value]:
        def answer() -> None:
            if on_subscriber is not None and (value := on_subscriber()) is not None:
                publisher.send(value)

        on_match = None if on_subscriber is None else lambda: self._loop.post(answer)
        publisher = RosPublisher(self._node, topic, kind, find_codec(kind), quality, on_match)
        return publisher

    def subscribe(
        self,
        topic: str,
        kind: type[Value],
        callback: Callable[[Value], None],
        quality: Quality = Quality.NEWEST,
        unreadable: Callable[[str], None] | None = None,
    ) -> RosSubscription[Value]:
        return self._listen(topic, kind, find_codec(kind), quality, lambda value, _sender: callback(value), unreadable)

    def subscribe_from(
        self,
        topic: str,
        kind: type[Value],
        callback: Callable[[Value, Sender | None], None],
        quality: Quality = Quality.NEWEST,
    ) -> RosSubscription[Value]:
        return self._listen(topic, kind, find_codec(kind), quality, callback, senders=True)

    def subscribe_fields(
        self, topic: str, type_name: str, fields: tuple[str, ...], callback: Callable[[tuple[Any, ...]], None]
    ) -> RosSubscription[tuple[Any, ...]]:
        from ur_nodes.codecs.foreign import find_foreign

        codec = find_foreign(type_name, fields)
        return self._listen(topic, tuple, codec, Quality.EVERY, lambda value, _sender: callback(value))

    def serve(self, service: str, kind: type[Value], answer: Callable[[Value], Result]) -> None:
        self.serve_later(service, kind, lambda request, give: give(answer(request)))

    def serve_later(
        self, service: str, kind: type[Value], callback: Callable[[Value, Callable[[Result], None]], None]
    ) -> None:
        self._services.serve(service, kind, callback)

    def call(self, service: str, request: object, callback: Callable[[Result], None], within: float = 5.0) -> None:
        self._services.call(service, request, callback, within)

    def serve_goals(self, action: str, handlers: GoalHandlers, kept: float = 5.0) -> GoalServer:
        from ur_nodes.goal_topics import TopicGoalServer
        from ur_nodes.ros2.navigation.server import NavigationActions

        server = TopicGoalServer(self, action, handlers, kept)
        if self._actions is None:
            self._actions = NavigationActions(self._node, self._executor, self._loop.post, self.now)
            self.on_end(self._actions.end)
        self._actions.serve(self.resolve(f"{action}/goal").removesuffix("/goal"), server, kept)
        return server

    def follow_goals(self, action: str, follower: GoalFollower) -> GoalClient:
        from ur_nodes.goal_topics import TopicGoalClient
        from ur_nodes.ros2.graph import has_node_between
        from ur_nodes.ros2.navigation.client import LIST_PERIOD, follow_actions

        name = self.resolve(f"{action}/goal").removesuffix("/goal")
        ends = self.resolve(f"{action}/goal"), self.resolve(f"{action}/status")
        topics = TopicGoalClient(self, action, follower, lambda: has_node_between(self._node, *ends))
        client = follow_actions(self._node, self._loop.post, name, topics, follower)
        if client is None:
            return topics
        self.every(LIST_PERIOD, client.beat, steady=True)
        return client

    def read_graph(self, callback: Callable[[Graph | None], None]) -> None:
        from ur_nodes.ros2.graph import read_graph

        self.work(lambda: read_graph(self._node), callback, "graph")

    @property
    def raw(self) -> Raw:
        from ur_nodes.ros2.raw import RosRaw

        return RosRaw(self._node, self._loop)

    def now(self) -> int:
        return int(self._clock.now().nanoseconds) if self._simulated else time.time_ns()

    def subscribed_kinds(self, topic: str, kinds: tuple[type, ...]) -> frozenset[type] | None:
        return self._known_kinds(self._node.get_subscriptions_info_by_topic(self.resolve(topic)), kinds)

    def kinds_sent(self, topic: str, kinds: tuple[type, ...]) -> frozenset[type] | None:
        return self._known_kinds(self._node.get_publishers_info_by_topic(self.resolve(topic)), kinds)

    def locate(self, name: str) -> Location | None:
        """See Node. The graph does not name computers: nodes of the domain are those of this one."""
        namespace, _, own = name.rpartition("/")
        known = (own, namespace or "/") in self._node.get_node_names_and_namespaces()
        return Location("localhost", here=True) if known else None

    def resolve(self, name: str) -> str:
        return resolve(self._node, name)

    def end(self, reason: str, *, failed: bool = False) -> None:
        self.failed = self.failed or failed
        self.ended(reason)

    def _known_kinds(self, ends: list[TopicEndpointInfo], kinds: tuple[type, ...]) -> frozenset[type]:
        own = (self._node.get_namespace(), self._node.get_name())
        types = {each.topic_type for each in ends if (each.node_namespace, each.node_name) != own}
        return frozenset(kind for kind in kinds if type_name_of(find_codec(kind).message_class) in types)

    def _seconds(self) -> float:
        return self.now() / 1e9

    def _listen(
        self,
        topic: str,
        kind: type,
        codec: KindCodec[Value],
        quality: Quality,
        callback: Callable[[Value, Sender | None], None],
        unreadable: Callable[[str], None] | None = None,
        *,
        senders: bool = False,
    ) -> RosSubscription[Value]:
        return RosSubscription(
            self._node, topic, kind, codec, quality, self._loop, callback, unreadable, senders=senders
        )


def _follow_clock(clock: Clock, call: Callable[[], None]) -> JumpHandle:
    """Call a function, on the spinning thread, when a clock has a new time, as long as the result is kept."""
    from rclpy.clock import JumpThreshold
    from rclpy.duration import Duration

    every = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))
    return clock.create_jump_callback(every, post_callback=lambda _jump: call())
