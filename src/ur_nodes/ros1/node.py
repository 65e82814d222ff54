"""A node of ROS 1."""

import time
from collections.abc import Callable, Mapping
from functools import partial
from http.client import HTTPException
from types import SimpleNamespace
from typing import Any, TypeVar, cast
from urllib.parse import urlsplit
from xml.parsers.expat import ExpatError
from xmlrpc.client import Error as XmlRpcError

import rosgraph
import rosgraph.network
import rospy

from ur_nodes.codecs import find_codec
from ur_nodes.loop import Loop
from ur_nodes.node_base import LoopNode
from ur_nodes.ports.actions import GoalClient, GoalFollower, GoalHandlers, GoalServer
from ur_nodes.ports.graph import Ends, Graph, make_graph
from ur_nodes.ports.log import ThrottledLog
from ur_nodes.ports.node import Location, Sender
from ur_nodes.ports.parameters import Declaration, Parameters
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import Raw
from ur_nodes.ports.transforms import Transforms
from ur_nodes.ports.values import ClockTime, Result
from ur_nodes.ros1.repairs.own_clock import follow_clock
from ur_nodes.ros1.repairs.sending import wait_until_sent
from ur_nodes.ros1.services import TransformTopics, call_service, serve_service
from ur_nodes.ros1.topics import RosClock, RosPublisher, RosRaw, RosSubscription, sender_of

Change = Callable[[dict[str, object]], str]
Config = dict[str, object]

_KINDS: dict[type, str] = {bool: "bool", int: "int", float: "double"}
_UNUSED: dict[str, object] = {"level": 0, "edit_method": ""}


def serve_changes(parameters: Parameters, change: Change) -> None:
    """Let other programs set what is live; `change` returns '' or the refusal. Raises ImportError: not installed."""
    from dynamic_reconfigure.server import Server

    class RefusingServer(Server):
        """Upstream's server. A value out of the limits is refused, and not moved into them."""

        def _clamp(self, config: dict[str, object]) -> None:
            """See Server."""

    live = {name: each for name, each in parameters.declared().items() if each.live}
    for folder in {name.rpartition("/")[0] for name in live}:
        here = {name[len(folder) + 1 :]: each for name, each in live.items() if name.rpartition("/")[0] == folder}
        RefusingServer(_describe(here), partial(_apply, parameters, change, folder), folder)


def _apply(parameters: Parameters, change: Change, folder: str, config: Config, _level: int) -> Config:
    """Apply a configuration, and return what is in use. Raises ServiceException with the reason of a refusal."""
    known, given = parameters.declared(), {f"{folder}/{name}": config[name] for name in config if name != "groups"}
    changed = {name: value for name, value in given.items() if name not in known or known[name].value != value}
    if changed and (reason := change(changed)):
        raise rospy.ServiceException(reason)
    config.update({name.rpartition("/")[2]: parameters.declared()[name].value for name in given})
    return config


def _describe(live: Mapping[str, Declaration]) -> SimpleNamespace:
    """Return what upstream generates as a class of constants."""
    described = [
        {"name": name, "type": _KINDS[type(each.value)], "description": f"{each.live} ({each.expected})", **_UNUSED}
        for name, each in live.items()
    ]
    group = {"name": "Default", "type": "", "id": 0, "parent": 0, "state": True, "groups": [], "parameters": described}
    return SimpleNamespace(
        config_description=group,
        defaults={name: each.value for name, each in live.items()},
        min={name: each.limits[0] for name, each in live.items()},
        max={name: each.limits[1] for name, each in live.items()},
    )


def read_graph(name: str) -> Graph | None:
    """Ask the master, in the name of a node; None while it does not answer, or answers with something else."""
    master = rosgraph.Master(name)
    try:
        published, subscribed, services = (_ends(each) for each in master.getSystemState())
        kinds = {str(topic): str(kind).replace("*", "") for topic, kind in master.getTopicTypes()}
    except Exception:  # of the network, of XML-RPC and its parser, or of what is no graph
        return None
    return make_graph(published, subscribed, kinds, services)


def _ends(found: Any) -> Ends:
    return {str(name): tuple(map(str, nodes)) for name, nodes in found}


_FACTS = {"run_id": "/run_id"}  # the others are below /ur


class RosFacts:
    """See `ports.facts.Facts`."""

    def __init__(self) -> None:
        self.simulated_time = rospy.get_param("/use_sim_time", False) is True

    def get(self, name: str, default: object = None) -> object:
        return rospy.get_param(_FACTS.get(name, f"/ur/{name}"), default)

    def set(self, name: str, value: object) -> None:
        rospy.set_param(_FACTS.get(name, f"/ur/{name}"), value)


class RosParameters:
    """See `ports.parameters.ParameterStore`."""

    def resolve(self, name: str) -> str:
        return str(rospy.resolve_name(name))

    def has(self, name: str) -> bool:
        return bool(rospy.has_param(name))

    def get(self, name: str) -> object:
        return rospy.get_param(name)

    def set(self, name: str, value: object) -> None:
        rospy.set_param(name, value)


def make_log() -> ThrottledLog:
    """The log of a node."""
    debug, info, warn, error = (
        partial(write, "%s") for write in (rospy.logdebug, rospy.loginfo, rospy.logwarn, rospy.logerr)
    )
    return ThrottledLog(debug, info, warn, error, rospy.get_time)


Value = TypeVar("Value")

_MOST_TRANSFORMS = 1000  # messages that wait while a callback takes long: a history with gaps is of no use
_SENT_LIMIT = 1.0  # s: for threads of a busy computer to send what is last
_LEAVE = 0.03  # s: and for it to leave


class RosNode(LoopNode):
    """See `ports.node.Node`. Made after rospy.init_node; `begin` starts its thread."""

    def __init__(self) -> None:
        self.name: str = rospy.get_name()
        self.facts = RosFacts()
        simulated = self.facts.simulated_time
        loop = Loop(rospy.get_time if simulated else time.monotonic, steady=not simulated)
        super().__init__(loop, make_log(), Parameters(RosParameters()))
        self._transforms: Transforms | None = None
        if simulated:
            follow_clock(self._loop.passed)
        rospy.on_shutdown(lambda: self.finish(_leave))

    def begin(self, on_failure: Callable[[], None] = lambda: None) -> None:
        """Start to run callbacks. When one fails, no more are run and `on_failure` is called."""
        self._loop.start(on_failure)
        try:
            serve_changes(self.parameters, self.change)
        except ImportError:
            self.log.debug("no package python3-dynamic-reconfigure: parameters are read at the start only")

    def ask(self, call: Callable[[], None]) -> None:
        """Call on the node's thread and wait for the result: for code with threads of its own, after `begin`."""
        self._loop.ask(call)

    @property
    def transforms(self) -> Transforms:
        if self._transforms is None:
            topics = TransformTopics()
            self._transforms = tree = Transforms(topics.send, self.log)
            topics.listen(self._loop.mailbox(_MOST_TRANSFORMS, tree.receive), self._loop.mailbox(None, tree.receive))
        return self._transforms

    @property
    def raw(self) -> Raw:
        return RosRaw(self._loop)

    def publish(
        self,
        topic: str,
        kind: type[Value],
        quality: Quality = Quality.NEWEST,
        on_subscriber: Callable[[], Value | None] | None = None,
    ) -> RosPublisher[Value]:
        if kind is ClockTime:
            return cast("RosPublisher[Value]", RosClock(topic, quality))
        publisher = RosPublisher(topic, find_codec(kind), quality)
        if on_subscriber is not None:

            def answer() -> None:
                if (value := on_subscriber()) is not None:
                    publisher.send(value)

            publisher.watch(lambda: self._loop.post(answer))
        return publisher

    def subscribe(
        self,
        topic: str,
        kind: type[Value],
        callback: Callable[[Value], None],
        quality: Quality = Quality.NEWEST,
        unreadable: Callable[[str], None] | None = None,
    ) -> RosSubscription[Value]:
        codec = find_codec(kind)
        return RosSubscription(
            topic, codec, quality, self._loop, lambda value, _message: callback(value), unreadable=unreadable
        )

    def subscribe_from(
        self,
        topic: str,
        kind: type[Value],
        callback: Callable[[Value, Sender | None], None],
        quality: Quality = Quality.NEWEST,
    ) -> RosSubscription[Value]:
        return RosSubscription(
            topic, find_codec(kind), quality, self._loop, lambda value, message: callback(value, sender_of(message))
        )

    def subscribe_fields(
        self, topic: str, type_name: str, fields: tuple[str, ...], callback: Callable[[tuple[Any, ...]], None]
    ) -> RosSubscription[tuple[Any, ...]]:
        from ur_nodes.codecs.foreign import find_foreign

        codec = find_foreign(type_name, fields)
        return RosSubscription(topic, codec, Quality.EVERY, self._loop, lambda value, _message: callback(value))

    def serve(self, service: str, kind: type[Value], answer: Callable[[Value], Result]) -> None:
        self.serve_later(service, kind, lambda request, give: give(answer(request)))

    def serve_later(
        self, service: str, kind: type[Value], callback: Callable[[Value, Callable[[Result], None]], None]
    ) -> None:
        serve_service(self._loop, service, kind, callback)

    def call(self, service: str, request: object, callback: Callable[[Result], None], within: float = 5.0) -> None:
        call_service(self._loop, service, request, callback, within)

    def serve_goals(self, action: str, handlers: GoalHandlers, kept: float = 5.0) -> GoalServer:
        from ur_nodes.ros1.goals import RosGoalServer

        return RosGoalServer(action, handlers, self._loop, kept)

    def follow_goals(self, action: str, follower: GoalFollower) -> GoalClient:
        from ur_nodes.ros1.goals import RosGoalClient

        return RosGoalClient(action, follower, self._loop)

    def now(self) -> int:
        return int(rospy.Time.now().to_nsec())

    def read_graph(self, callback: Callable[[Graph | None], None]) -> None:

        self.work(lambda: read_graph(self.name), callback, "graph")

    def subscribed_kinds(self, topic: str, kinds: tuple[type, ...]) -> frozenset[type] | None:  # noqa: ARG002
        """See Node. The master knows the types of publishers only."""
        return None

    def kinds_sent(self, topic: str, kinds: tuple[type, ...]) -> frozenset[type] | None:  # noqa: ARG002
        """See Node. It does not ask the master, since nodes of ROS 1 send Twist."""
        return None

    def locate(self, name: str) -> Location | None:
        try:
            host = urlsplit(rosgraph.Master(self.name).lookupNode(name)).hostname
        except (OSError, ValueError, rosgraph.MasterException, HTTPException, XmlRpcError, ExpatError):
            return None
        return Location(host, rosgraph.network.is_local_address(host)) if host else None

    def resolve(self, name: str) -> str:
        return str(rospy.resolve_name(name))

    def end(self, reason: str, *, failed: bool = False) -> None:
        self.failed = self.failed or failed
        rospy.signal_shutdown(reason)


def _leave() -> None:
    """Wait until the last messages are sent."""
    publishers = tuple(rospy.topics.get_topic_manager().pubs.values())
    wait_until_sent((each for one in publishers for each in tuple(one.connections)), _SENT_LIMIT)
    time.sleep(_LEAVE)
