"""The graph and the senders of messages, as a node of rclpy reports them."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

import pytest

from ur_nodes.ports.graph import Topic
from ur_nodes.ros2.graph import Senders, has_node_between, read_graph, waiting_time

if TYPE_CHECKING:
    from rclpy.node import Node

Ends = dict[tuple[str, str], list[tuple[str, list[str]]]]
FIRST, SECOND = b"\x01" * 16, b"\x02" * 16
TWIST = "geometry_msgs/msg/Twist"


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A publisher of a topic, or a subscription."""

    node_name: str
    endpoint_gid: bytes
    node_namespace: str = "/"


@dataclass(slots=True)
class ReportingNode:
    """What rclpy's node has discovered: ends by name and namespace of their nodes, and those of topics."""

    published: Ends = field(default_factory=dict)
    subscribed: Ends = field(default_factory=dict)
    served: Ends = field(default_factory=dict)
    endpoints: list[Endpoint] = field(default_factory=list)
    listening: list[Endpoint] = field(default_factory=list)
    asked: int = 0

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return sorted({*self.published, *self.subscribed, *self.served})

    def get_publisher_names_and_types_by_node(self, name: str, namespace: str) -> list[tuple[str, list[str]]]:
        return self.published.get((name, namespace), [])

    def get_subscriber_names_and_types_by_node(self, name: str, namespace: str) -> list[tuple[str, list[str]]]:
        return self.subscribed.get((name, namespace), [])

    def get_service_names_and_types_by_node(self, name: str, namespace: str) -> list[tuple[str, list[str]]]:
        return self.served.get((name, namespace), [])

    def get_publishers_info_by_topic(self, _topic: str) -> list[Endpoint]:
        self.asked += 1
        return self.endpoints

    def get_subscriptions_info_by_topic(self, _topic: str) -> list[Endpoint]:
        return self.listening


def senders_of(*endpoints: Endpoint) -> tuple[Senders, ReportingNode]:
    node = ReportingNode(endpoints=list(endpoints))
    return Senders(cast("Node", node), "/cmd_vel"), node


def info(sent: int, number: int | None = None, gid: bytes | None = None, received: int = 0) -> dict[str, object]:
    return {
        "received_timestamp": received,
        "source_timestamp": sent,
        "publication_sequence_number": number,
        "publisher_gid": {"data": gid} if gid else None,
    }


def test_graph_has_the_ends_of_all_nodes_and_no_services_that_every_node_has() -> None:
    node = ReportingNode(
        published={("mux", "/robot"): [("/cmd_vel", [TWIST])]},
        subscribed={("base", "/"): [("/cmd_vel", [TWIST])], ("mux", "/robot"): [("/scan", ["sensor_msgs/msg/X"])]},
        served={("base", "/"): [("/base/list_parameters", ["x"]), ("/reset", ["std_srvs/srv/Empty"])]},
    )
    graph = read_graph(cast("Node", node))
    assert graph.nodes == ("/base", "/robot/mux")
    assert graph.topics["/cmd_vel"] == Topic("/cmd_vel", TWIST, ("/robot/mux",), ("/base",))
    assert graph.topics["/scan"].publishers == ()
    assert graph.services == {"/reset": ("/base",)}


def test_message_with_the_id_of_its_publisher_has_that_ones_name() -> None:
    senders, node = senders_of(Endpoint("keys", FIRST), Endpoint("page", SECOND, "/robot"))
    assert [senders.find(info(5, gid=each)).name for each in (FIRST, SECOND, FIRST)] == [
        "/keys",
        "/robot/page",
        "/keys",
    ]
    assert node.asked == 1
    assert senders.find(info(5, gid=FIRST)).sent == 5


def test_sender_that_is_no_node_is_described() -> None:
    senders, _ = senders_of(Endpoint("_NODE_NAME_UNKNOWN_", FIRST))
    assert senders.find(info(5, gid=FIRST)).name == "a program that is no node"


def test_name_of_a_node_that_becomes_known_after_its_first_message_is_found() -> None:
    senders, node = senders_of(Endpoint("_NODE_NAME_UNKNOWN_", FIRST))
    senders.find(info(5, gid=FIRST))
    node.endpoints = [Endpoint("_ros2cli_7", FIRST)]
    assert senders.find(info(6, gid=FIRST)).name == "/_ros2cli_7"


@pytest.mark.parametrize(
    ("received", "waited"),
    [(10**18 - 90_000_000, 0.09), (10**18 + 1, 0.0), (1, 0.15), (0, 0.0), (None, 0.0)],
    ids=["before", "clock set back", "clock set ahead", "unknown", "no field"],
)
def test_message_arrived_when_the_middleware_received_it_at_any_clock(received: int | None, waited: float) -> None:
    assert waiting_time(received, 10**18) == pytest.approx(waited)


def test_message_never_arrives_before_an_earlier_one() -> None:
    senders, _ = senders_of(Endpoint("keys", FIRST))
    first = senders.find(info(5, gid=FIRST)).arrived
    later = senders.find(info(6, gid=FIRST, received=time.time_ns() - 10**9)).arrived
    assert first is not None
    assert later == first


def test_sender_that_has_left_the_graph_has_no_name() -> None:
    senders, _ = senders_of()
    assert senders.find(info(0, gid=FIRST)).name == ""
    assert senders.find(info(0, gid=FIRST)).sent is None


def test_message_without_an_id_is_of_the_only_publisher_and_the_graph_is_asked_once() -> None:
    senders, node = senders_of(Endpoint("keys", FIRST))
    assert {senders.find(info(number, number)).id for number in (1, 2, 3)} == {FIRST.hex()}
    assert node.asked == 1


def test_another_publisher_is_looked_for_where_numbers_or_stamps_leap() -> None:
    senders, node = senders_of(Endpoint("keys", FIRST))
    senders.find(info(1, 1))
    node.endpoints[:] = [Endpoint("page", SECOND)]
    assert senders.find(info(2, 9)).name == "/page"
    node.endpoints[:] = [Endpoint("keys", FIRST)]
    assert senders.find(info(1, 10)).name == "/keys"


def test_several_publishers_without_ids_have_one_and_the_name_of_all() -> None:
    senders, _ = senders_of(Endpoint("keys", FIRST), Endpoint("page", SECOND))
    found = [senders.find(info(1, number)) for number in (1, 1)]
    assert {(each.id, each.name) for each in found} == {("several", "one of /keys, /page")}


def test_streams_of_publishers_without_ids_are_told_apart_by_the_numbers_of_their_messages() -> None:
    senders, _ = senders_of(Endpoint("keys", FIRST), Endpoint("page", SECOND))
    sent = [(7, 10), (70, 90), (8, 20), (71, 91), (9, 30), (11, 50), (72, 92), (12, 60), (12, 5)]
    streams = [senders.find(info(moment, number)).stream for number, moment in sent]
    keys, page, _, _, _, again, _, _, other = streams
    assert streams == [keys, page, keys, page, keys, again, page, again, other]  # the number 10 was lost
    assert len({keys, page, again, other}) == 4


def test_publishers_of_a_middleware_that_numbers_no_messages_have_one_stream() -> None:
    senders, _ = senders_of(Endpoint("keys", FIRST), Endpoint("page", SECOND))
    assert {senders.find(info(moment)).stream for moment in (1, 2, 3)} == {""}


def test_recorder_of_a_topic_is_not_taken_for_the_node_that_answers_on_another() -> None:
    unknown, recorder, server = (Endpoint(name, FIRST) for name in ("_NODE_NAME_UNKNOWN_", "black_box", "move_base"))
    node = ReportingNode(endpoints=[unknown, server], listening=[unknown, recorder])
    assert not has_node_between(cast("Node", node), "/move_base/goal", "/move_base/status")
    node.listening.append(server)
    assert has_node_between(cast("Node", node), "/move_base/goal", "/move_base/status")
