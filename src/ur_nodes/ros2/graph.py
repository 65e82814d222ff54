"""The graph of a domain."""

from __future__ import annotations

from collections import defaultdict

from rclpy.node import Node

from ur_nodes.ports.graph import Graph, make_graph
from ur_nodes.ros2.names import full_name

_OWN = ("/describe_parameters", "/get_parameter_types", "/get_parameters", "/get_type_description")
_OWN_SERVICES = (*_OWN, "/list_parameters", "/set_parameters", "/set_parameters_atomically")


def read_graph(node: Node) -> Graph:
    """Ask a node of rclpy for all that it has discovered."""
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


def _tuples(ends: dict[str, list[str]]) -> dict[str, tuple[str, ...]]:
    return {name: tuple(nodes) for name, nodes in ends.items()}
