"""Topics of ROS 2 whose publishers and subscribers never connect: types, definitions, QoS; and velocity topics."""

from collections.abc import Iterator

from ur.robot.doctor.findings import Finding, Where
from ur.robot.doctor.rules.registry import Rule, SideRule
from ur.robot.doctor.side import Side
from ur.robot.ros2.seen_graph import End, Qos, SeenTopic

TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
MUXES = ("cmd_vel_mux", "twist_mux")
SHOWN = 3


def check_types(where: Where, side: Side) -> Iterator[Finding]:  # noqa: ARG001 - of the protocol
    """Check for topics whose publishers and subscribers have different types, or different definitions of one type."""
    for topic in _topics(side):
        kinds = {end.kind for end in topic.publishers}
        lost = [end for end in topic.subscribers if kinds and end.kind not in kinds]
        if lost and {TWIST, STAMPED} == {*kinds, *(end.kind for end in lost)}:
            wanted = _short(lost[0].kind)
            stamped = "true" if lost[0].kind == STAMPED else "false"
            yield Finding(
                "ros2-command-type",
                f"{side.name}: {topic.name} never arrives: {_ends(topic.publishers, kinds=True)} publishes, and "
                f"{_ends(lost, kinds=True)} subscribes",
                f"have the publisher send {wanted}: a parameter of most programs (teleop_twist_keyboard: stamped:="
                f"{stamped}; teleop_twist_joy: publish_stamped_twist:={stamped}; Nav2: enable_stamped_cmd_vel: "
                f"{stamped}); the mux of this project takes both types and sends what the base takes",
            )
        elif lost:
            yield Finding(
                "ros2-topic-type",
                f"{side.name}: {topic.name} has two types: {_ends(topic.publishers, kinds=True)} publishes, and "
                f"{_ends(lost, kinds=True)} subscribes; they never connect",
                f"remap one of the two to another name: --ros-args -r {topic.name}:={topic.name}_2",
            )
        yield from _check_hashes(side, topic)


def _check_hashes(side: Side, topic: SeenTopic) -> Iterator[Finding]:
    known = {(end.kind, end.hash) for end in (*topic.publishers, *topic.subscribers) if end.hash}
    for kind in sorted({kind for kind, _ in known}):
        if sum(each == kind for each, _ in known) > 1:
            first = next(end for end in (*topic.publishers, *topic.subscribers) if end.kind == kind and end.hash)
            other = [
                end
                for end in (*topic.publishers, *topic.subscribers)
                if end.kind == kind and end.hash not in ("", first.hash)
            ]
            package = kind.split("/")[0]
            yield Finding(
                "ros2-definition",
                f"{side.name}: {topic.name}: {first.node} and {_ends(other)} have different definitions of "
                f"{_short(kind)}; data are lost or misread",
                f"have one release of {package} on all computers, and build workspaces with it again",
            )


def check_qualities(where: Where, side: Side) -> Iterator[Finding]:  # noqa: ARG001 - of the protocol
    """Check for publishers and subscribers that never connect, since one requests more QoS than the other offers."""
    for topic in _topics(side):
        for subscriber in topic.subscribers:
            for publisher in topic.publishers:
                if publisher.kind == subscriber.kind and (reason := explain_mismatch(publisher.qos, subscriber.qos)):
                    offer, fix = reason
                    yield Finding(
                        "ros2-qos",
                        f"{side.name}: {topic.name}: {subscriber.node} never receives from {publisher.node}: {offer}",
                        fix.format(publisher=publisher.node, subscriber=subscriber.node),
                    )


def explain_mismatch(offered: Qos, requested: Qos) -> tuple[str, str] | None:
    """Explain why two QoS profiles never match, and how to change that; None if they match (DDS 1.4, 2.2.3)."""
    if requested.reliable and not offered.reliable:
        return (
            "it asks for reliable, and best effort is offered",
            "subscribe with best effort (rclpy: qos_profile_sensor_data; RViz: Reliability Policy of the display) in "
            "{subscriber}",
        )
    if requested.latched and not offered.latched:
        return (
            "it asks for transient local, and volatile is offered",
            "subscribe with volatile durability in {subscriber}, or publish with transient local in {publisher}",
        )
    if offered.deadline > requested.deadline:
        offer = f"{offered.deadline:g} s" if offered.deadline < float("inf") else "none"
        return (
            f"it asks for a deadline of {requested.deadline:g} s, and {offer} is offered",
            "leave the deadline out in {subscriber}, or offer it in {publisher}",
        )
    if requested.manual and not offered.manual:
        return (
            "it asks for liveliness by topic, and automatic is offered",
            "ask for automatic liveliness in {subscriber}",
        )
    if offered.lease > requested.lease:
        return (
            f"it asks for a liveliness lease of {requested.lease:g} s, and a longer one is offered",
            "leave the lease out in {subscriber}, or offer it in {publisher}",
        )
    return None


def check_commands(where: Where, side: Side) -> Iterator[Finding]:  # noqa: ARG001 - of the protocol
    """Check the velocity commands: no node subscribes to them, or a node bypasses the mux."""
    topics = [each for each in _topics(side) if {end.kind for end in _all(each)} & {TWIST, STAMPED}]
    listened = [each for each in topics if any(_base_name(end.node) not in MUXES for end in each.subscribers)]
    for topic in topics:
        if topic.publishers and not topic.subscribers and topic.name.endswith("cmd_vel") and not listened:
            yield Finding(
                "ros2-no-base",
                f"{side.name}: {_ends(topic.publishers)} publishes {topic.name}, and no node subscribes to it; the "
                "base's driver does not run, or has another name or namespace",
                "start the base's driver; the names: ros2 topic list -t",
            )
        muxes = [end for end in topic.publishers if _base_name(end.node) in MUXES]
        others = [end for end in topic.publishers if _base_name(end.node) not in MUXES]
        if muxes and others and topic.subscribers:
            yield Finding(
                "ros2-second-commander",
                f"{side.name}: {_ends(others)} publishes {topic.name} past the mux {muxes[0].node}: neither the "
                "obstacle stop nor the age limit of commands applies to it",
                f"have it publish the name that the mux takes over: --ros-args -r {topic.name}:=cmd_vel; or end it",
            )


def _topics(side: Side) -> tuple[SeenTopic, ...]:
    return side.ros2.graph.topics if side.ros2.graph else ()


def _all(topic: SeenTopic) -> tuple[End, ...]:
    return (*topic.publishers, *topic.subscribers)


def _base_name(node: str) -> str:
    return node.rpartition("/")[2]


def _short(kind: str) -> str:
    return kind.rpartition("/")[2]


def _ends(ends: tuple[End, ...] | list[End], *, kinds: bool = False) -> str:
    shown = list(dict.fromkeys(f"{end.node} ({_short(end.kind)})" if kinds else end.node for end in ends))
    return ", ".join(shown[:SHOWN]) + (" ..." if len(shown) > SHOWN else "")


RULES: tuple[Rule, ...] = (
    SideRule(
        {
            "ros2-command-type": "commands are sent as Twist and taken as TwistStamped, or the other way round",
            "ros2-topic-type": "the ends of a topic have different types",
            "ros2-definition": "two nodes have different definitions of one type",
        },
        check_types,
        simulation=True,
    ),
    SideRule({"ros2-qos": "a subscriber asks for more than the publisher offers"}, check_qualities, simulation=True),
    SideRule(
        {
            "ros2-no-base": "commands are sent, and no base takes them",
            "ros2-second-commander": "a node commands the base past the mux",
        },
        check_commands,
        simulation=True,
    ),
)
