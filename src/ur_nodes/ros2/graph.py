"""The graph of a domain, and the senders of messages, by the middleware's information about each message."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from ur_nodes.ports.graph import Graph, make_graph
from ur_nodes.ports.topics import Sender
from ur_nodes.ros2.names import full_name

if TYPE_CHECKING:
    from rclpy.node import Node, TopicEndpointInfo

_OWN = ("/describe_parameters", "/get_parameter_types", "/get_parameters", "/get_type_description")
_OWN_SERVICES = (*_OWN, "/list_parameters", "/set_parameters", "/set_parameters_atomically")

_SEVERAL = "several"
_MOST = 1000  # publishers that are remembered
_MOST_STREAMS = 32
_UNKNOWN = ("_CREATED_BY_BARE_DDS_APP_", "_NODE_NAME_UNKNOWN_")  # names of programs that are no nodes
_UNNAMED = "a program that is no node"
_LONGEST_WAIT = 0.15  # s in which a message waits to be taken; beyond, the clock was set meanwhile


def read_graph(node: Node) -> Graph:
    """Read everything that a node of rclpy has discovered."""
    publishers: dict[str, list[str]] = defaultdict(list)
    subscribers: dict[str, list[str]] = defaultdict(list)
    services: dict[str, list[str]] = defaultdict(list)
    kinds: dict[str, str] = {}
    nodes = []
    for name, namespace in node.get_node_names_and_namespaces():
        full = full_name(namespace, name)
        nodes.append(full)
        for ends, read in (
            (publishers, node.get_publisher_names_and_types_by_node),
            (subscribers, node.get_subscriber_names_and_types_by_node),
        ):
            for topic, types in read(name, namespace):
                ends[topic].append(full)
                kinds.setdefault(topic, types[0])
        for service, _types in node.get_service_names_and_types_by_node(name, namespace):
            if not service.endswith(_OWN_SERVICES):
                services[service].append(full)
    return make_graph(_tuples(publishers), _tuples(subscribers), kinds, _tuples(services), nodes)


def has_node_between(node: Node, subscribed: str, published: str) -> bool:
    """Return whether a node that subscribes to one topic, and publishes the other, has been discovered."""

    def names(ends: Iterable[TopicEndpointInfo]) -> set[str]:
        return {
            full_name(each.node_namespace, each.node_name) for each in ends if not each.node_name.startswith(_UNKNOWN)
        }

    subscribers = names(node.get_subscriptions_info_by_topic(subscribed))
    return bool(subscribers & names(node.get_publishers_info_by_topic(published)))


def _tuples(ends: dict[str, list[str]]) -> dict[str, tuple[str, ...]]:
    return {name: tuple(nodes) for name, nodes in ends.items()}


class Senders:
    """Finds the senders of the messages of a topic.

    rclpy gives the id of the publisher from Kilted on. Before, a topic with one publisher has that one's id, and all
    publishers of a topic with several have one id; there the numbers that publishers give their messages tell streams
    apart. The graph is asked when the publisher may have changed only.
    """

    def __init__(self, node: Node, topic: str) -> None:
        self._node, self._topic = node, topic
        self._names: dict[str, str] = {}
        self._arrived = 0.0  # the last message; a message has arrived before this thread takes it
        self._id = ""
        self._last = (-1, -1)  # number and stamp of the last message, where they say whether another publisher began
        self._streams: dict[int, tuple[int, int]] = {}  # likewise of each stream, that of the last message last
        self._began = 0  # streams

    def find(self, info: Mapping[str, Any]) -> Sender:
        """Return the sender of a message that was just received."""
        waited = waiting_time(info.get("received_timestamp"), time.time_ns())
        self._arrived = arrived = max(self._arrived, time.clock_gettime(time.CLOCK_BOOTTIME) - waited)
        sent = int(info["source_timestamp"])
        gid = info.get("publisher_gid")
        id = bytes(gid["data"]).hex() if gid else self._infer(info.get("publication_sequence_number"), sent)
        if self._names.get(id, _UNNAMED) == _UNNAMED:  # its name may arrive after its first messages
            self._ask()
            self._names.setdefault(id, "")
        number = info.get("publication_sequence_number")  # Cyclone DDS gives none
        stream = self._find_stream(number, sent) if id == _SEVERAL and number is not None else ""
        return Sender(self._names[id], id=id, sent=sent or None, arrived=arrived, stream=stream)

    def _infer(self, number: int | None, sent: int) -> str:
        last, last_sent = self._last
        self._last = (-1 if number is None else number, sent)
        if number is None or number != last + 1 or sent < last_sent:
            known = self._ask()
            self._id = known[0] if len(known) == 1 else _SEVERAL
            self._names[_SEVERAL] = "one of " + ", ".join(sorted({self._names[each] for each in known}))
        return self._id

    def _find_stream(self, number: int, sent: int) -> str:
        """Find the stream that a message continues, or begin another."""
        before = {
            stream: sent - last_sent
            for stream, (last, last_sent) in self._streams.items()
            if number == last + 1 and sent >= last_sent
        }
        if before:
            found = min(before, key=before.__getitem__)
        else:
            found = self._began = self._began + 1
        self._streams.pop(found, None)
        self._streams[found] = (number, sent)
        if len(self._streams) > _MOST_STREAMS:
            del self._streams[next(iter(self._streams))]
        return str(found)

    def _ask(self) -> list[str]:
        """Store the names of the present publishers, and return their ids."""
        found = {}
        for each in self._node.get_publishers_info_by_topic(self._topic):
            named = not each.node_name.startswith(_UNKNOWN)
            name = full_name(each.node_namespace, each.node_name) if named else _UNNAMED
            found[bytes(each.endpoint_gid).hex()] = name[:256]
        self._names |= found
        while len(self._names) > _MOST:
            del self._names[next(iter(self._names))]
        return list(found)


def waiting_time(received: int | None, now: int) -> float:
    """Return how long (s) a message waited to be taken, which the middleware received at a time (ns); 0: unknown."""
    return max(0.0, min((now - received) / 1e9, _LONGEST_WAIT)) if received else 0.0
