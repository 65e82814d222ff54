"""Survey of a graph for `ur doctor`: a program in one file that needs only rclpy and the messages of its release.

`ur` sends it to robots without this project; it prints JSON (see `ur.robot.ros2.seen_graph.SeenGraph`). It publishes
nothing and changes nothing.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import rclpy.node
from rclpy.qos import QoSProfile, ReliabilityPolicy

if TYPE_CHECKING:
    from lifecycle_msgs.srv import GetState
    from rcl_interfaces.srv import GetParameters
    from rclpy.duration import Duration
    from rclpy.node import Client, Node, TopicEndpointInfo
    from rclpy.task import Future
    from sensor_msgs.msg import BatteryState, LaserScan
    from tf2_msgs.msg import TFMessage

SETTLE = (1.5, 6.0)  # s: the least and most that discovery is waited for
MISSING = 18.0  # s: the most while participants of this computer are not discovered, as on a busy one
_TURNS = 12  # of 0.1 s without any news: a busy computer takes longer for them
LISTEN = 2.5  # s
ANSWER = 3.0  # s for parameters and states
MOST = 500  # topics, and nodes
_NEVER = 2**62  # ns
_GID = 16  # bytes of the id of a publisher
_PARTICIPANT = 12  # bytes of it that its participant has
_UNNAMED = "_NODE_NAME_UNKNOWN_"
_OWN = ("/rosout", "/parameter_events")
_LOOSE = QoSProfile(depth=20, reliability=ReliabilityPolicy.BEST_EFFORT)
_SCAN, _BATTERY, _TF = "sensor_msgs/msg/LaserScan", "sensor_msgs/msg/BatteryState", "tf2_msgs/msg/TFMessage"


def survey(node: Node) -> dict[str, object]:
    """Wait for discovery, then query nodes and receive messages."""
    wait_until_settled(node)
    nodes = [full_name(space, name) for name, space in node.get_node_names_and_namespaces()][:MOST]
    nodes.remove(full_name(node.get_namespace(), node.get_name()))
    kinds = {name: types[0] for name, types in node.get_topic_names_and_types() if name not in _OWN}
    kinds = dict(list(kinds.items())[:MOST])
    topics = [read_topic(node, name) for name in sorted(kinds)]
    topics = [each for each in topics if each["publishers"] or each["subscribers"]]
    services = {name: types[0] for name, types in node.get_service_names_and_types()}
    simulated: dict[str, bool] = {}
    states: dict[str, str] = {}
    ask_nodes(
        node,
        [each for each in sorted(set(nodes)) if not each.rpartition("/")[2].startswith("_")],
        services,
        simulated,
        states,
    )
    subscriptions = SurveySubscriptions(node, kinds)
    end = time.monotonic() + LISTEN
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.1)
    return {
        "nodes": sorted(each for each in nodes if not each.rpartition("/")[2].startswith("_")),
        "topics": topics,
        "simulated": simulated,
        "states": states,
        "scans": subscriptions.scans,
        "charge": subscriptions.charge,
        "frames": subscriptions.frames,
    }


def full_name(namespace: str, name: str) -> str:
    """The full name of a node."""
    return f"{namespace.rstrip('/')}/{name}"


def wait_until_settled(node: Node) -> None:
    """Wait until nothing new is discovered, and everything on this computer is.

    Each participant of DDS is bound to a port of its own, so their least number is known before they answer. An end
    without the name of its node is one whose name is still to arrive, or a program that is no node.
    """
    begin = time.monotonic()
    known: object = None
    since = missing = begin  # the last news; when participants were missing last
    turns = 0
    while (now := time.monotonic()) - begin < MISSING:
        seen, participants, named = look_at(node)
        if seen != known:
            known, since, turns = seen, now, 0
        ports = read_udp_ports()
        first = 7410 + 250 * node.context.get_domain_id()
        if participants < sum(port in ports for port in range(first, first + 240, 2)):
            missing = now
        elif (named and turns >= _TURNS and now - since >= SETTLE[0]) or now - missing >= SETTLE[1]:
            return
        rclpy.spin_once(node, timeout_sec=0.1)
        turns += 1


def look_at(node: Node) -> tuple[object, int, bool]:
    """Return numbers that change with discoveries, the participants, and whether all endpoints have a node's name."""
    nodes = sorted(node.get_node_names_and_namespaces())
    topics = node.get_topic_names_and_types()[:MOST]
    ends = [
        end
        for name, _ in topics
        for read in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic)
        for end in read(name)
    ]
    participants = {bytes(end.endpoint_gid)[:_PARTICIPANT] for end in ends}
    named = all(end.node_name != _UNNAMED for end in ends)
    return (nodes, len(topics), len(ends)), len(participants), named


def read_udp_ports() -> set[int]:
    """Read the open UDP ports of IPv4; none if that fails."""
    try:
        with open("/proc/net/udp") as file:  # noqa: PTH123 - as in all programs of one file
            rows = [line.split() for line in file.read().splitlines()[1:]]
    except OSError:
        return set()
    return {int(row[1].rpartition(":")[2], 16) for row in rows if len(row) > 1 and ":" in row[1]}


def read_topic(node: Node, topic: str) -> dict[str, object]:
    """Read the publishers and subscribers of a topic."""

    def describe_all(ends: Iterable[TopicEndpointInfo]) -> list[dict[str, object]]:
        found = [describe_end(each) for each in ends if each.node_name != node.get_name()]
        return sorted(found, key=repr)

    publishers, subscribers = node.get_publishers_info_by_topic(topic), node.get_subscriptions_info_by_topic(topic)
    return {"name": topic, "publishers": describe_all(publishers), "subscribers": describe_all(subscribers)}


def describe_end(end: TopicEndpointInfo) -> dict[str, object]:
    """Describe an endpoint; times in s, None for never."""
    qos = end.qos_profile
    number = getattr(end, "topic_type_hash", None)
    text = str(number) if number is not None else ""
    times = {"deadline": seconds(qos.deadline), "lease": seconds(qos.liveliness_lease_duration)}
    qualities = {
        "reliable": qos.reliability.name != "BEST_EFFORT",
        "latched": qos.durability.name == "TRANSIENT_LOCAL",
        "manual": qos.liveliness.name == "MANUAL_BY_TOPIC",
        **{name: value for name, value in times.items() if value is not None},
    }
    return {
        "node": full_name(end.node_namespace, end.node_name),
        "kind": str(end.topic_type),
        "hash": text if text.startswith("RIHS") else "",
        "qos": qualities,
    }


def seconds(duration: Duration) -> float | None:
    """Convert a duration to s; None if it is infinite."""
    return None if not 0 < duration.nanoseconds < _NEVER else duration.nanoseconds / 1e9


@dataclass
class OpenRequest:
    """A request to a service that has not been answered; `future` is None until the service is ready."""

    client: Client
    request: GetParameters.Request | GetState.Request
    callback: Callable[[object], None]
    future: Future | None = None


def ask_nodes(
    node: Node, names: list[str], services: dict[str, str], simulated: dict[str, bool], states: dict[str, str]
) -> None:
    """Ask all nodes at the same time whether their time is simulated, and managed nodes for their state."""
    from lifecycle_msgs.srv import GetState
    from rcl_interfaces.srv import GetParameters

    waiting: list[OpenRequest] = []

    def on_time(name: str, answer: GetParameters.Response) -> None:
        if answer.values and answer.values[0].type == 1:
            simulated[name] = bool(answer.values[0].bool_value)

    def on_state(name: str, answer: GetState.Response) -> None:
        states[name] = str(answer.current_state.label)

    for name in names:
        if services.get(service := f"{name}/get_parameters") == "rcl_interfaces/srv/GetParameters":
            request = GetParameters.Request(names=["use_sim_time"])
            waiting.append(OpenRequest(node.create_client(GetParameters, service), request, partial(on_time, name)))
        if services.get(service := f"{name}/get_state") == "lifecycle_msgs/srv/GetState":
            client = node.create_client(GetState, service)
            waiting.append(OpenRequest(client, GetState.Request(), partial(on_state, name)))
    end = time.monotonic() + ANSWER
    while waiting and time.monotonic() < end:
        for each in list(waiting):
            if each.future is None and each.client.service_is_ready():
                each.future = each.client.call_async(each.request)
            elif each.future is not None and each.future.done():
                each.callback(each.future.result())
                waiting.remove(each)
        rclpy.spin_once(node, timeout_sec=0.05)


class SurveySubscriptions:
    """Receives scans, battery states and tf, by topic or frame, as lists for output."""

    def __init__(self, node: Node, kinds: dict[str, str]) -> None:
        self.scans: dict[str, dict[str, float]] = {}
        self.charge: dict[str, float] = {}
        self._frames: dict[str, tuple[set[str], set[str]]] = {}
        self._owners: dict[bytes, str] = {}
        self._node = node
        for name, kind in kinds.items():
            if kind == _SCAN and node.count_publishers(name):
                self._receive_scans(name)
            elif kind == _BATTERY:
                self._receive_battery(name)
            elif kind == _TF and name == "/tf":
                self._receive_transforms(name)

    @property
    def frames(self) -> dict[str, dict[str, list[str]]]:
        """By frame: the nodes that send it, and its parents."""
        return {
            child: {"senders": sorted(senders), "parents": sorted(parents)}
            for child, (senders, parents) in self._frames.items()
        }

    def _receive_scans(self, topic: str) -> None:
        from sensor_msgs.msg import LaserScan

        found = self.scans[topic] = {"messages": 0}

        def on_message(message: LaserScan) -> None:
            stamp = message.header.stamp
            age = time.time() - (stamp.sec + stamp.nanosec / 1e9)
            found["messages"] += 1
            found["age"] = min(found.get("age", age), age, key=abs)  # others have waited here

        self._node.create_subscription(LaserScan, topic, on_message, _LOOSE)

    def _receive_battery(self, topic: str) -> None:
        from sensor_msgs.msg import BatteryState

        def on_message(message: BatteryState) -> None:
            if math.isfinite(message.percentage):
                self.charge[topic] = message.percentage

        self._node.create_subscription(BatteryState, topic, on_message, _LOOSE)

    def _receive_transforms(self, topic: str) -> None:
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:  # ROS 2 from wheels has none
            return
        for end in self._node.get_publishers_info_by_topic(topic):
            self._owners[bytes(end.endpoint_gid)[:_GID]] = full_name(end.node_namespace, end.node_name)
        profile = QoSProfile(depth=200, reliability=ReliabilityPolicy.BEST_EFFORT)
        humble = not hasattr(rclpy.node.Subscription, "CallbackType")  # passes messages alone
        receive = partial(self._on_transforms, details={}) if humble else self._on_transforms
        self._node.create_subscription(TFMessage, topic, receive, profile)

    def _on_transforms(self, message: TFMessage, details: Mapping[str, object]) -> None:
        number = details.get("publisher_gid") if isinstance(details, dict) else None
        data = number.get("data", b"") if isinstance(number, dict) else b""
        sender = self._owners.get(bytes(data)[:_GID], "")  # "" where the release does not tell it
        for each in message.transforms:
            senders, parents = self._frames.setdefault(each.child_frame_id.lstrip("/"), (set(), set()))
            parents.add(each.header.frame_id.lstrip("/"))
            senders.update([sender] if sender else [])


def main() -> None:
    """Survey, and print the result."""
    quiet = [f"--disable-{each}-logs" for each in ("stdout", "rosout", "external-lib")]
    rclpy.init(args=["ur_doctor", "--ros-args", *quiet])
    node = rclpy.create_node("ur_doctor", enable_rosout=False, start_parameter_services=False)
    found = survey(node)
    sys.stdout.write(json.dumps(found) + "\n")
    sys.stdout.flush()
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
