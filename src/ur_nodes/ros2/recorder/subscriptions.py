"""Subscriptions of bytes: to topics of any type and of any quality."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rclpy.qos import ReliabilityPolicy

from ur_nodes.ports.qualities import Quality
from ur_nodes.ros2.messages.bare_type import bare_class, reset_error
from ur_nodes.ros2.messages.packages import find_class, find_schema, split_type
from ur_nodes.ros2.qualities import requested

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.node import Node, Subscription, TopicEndpointInfo


@dataclass(frozen=True, slots=True)
class TopicPublishers:
    """Type of a topic, whether all its publishers keep the newest message, and whether one of them is best effort."""

    kind: str
    message_class: type
    latched: bool
    loose: bool


def read_publishers(node: Node, topic: str) -> TopicPublishers | None:
    """Read what the publishers of a topic offer; None: it has none, or a type that this release cannot receive."""
    found = node.get_publishers_info_by_topic(topic)
    if not found:
        return None
    kind = str(found[0].topic_type)
    message_class = find_class(kind) or _bare_class_of(found[0])
    if message_class is None:
        return None
    latched = all(each.qos_profile.durability.name == "TRANSIENT_LOCAL" for each in found)
    loose = any(each.qos_profile.reliability.name == "BEST_EFFORT" for each in found)
    return TopicPublishers(kind, message_class, latched, loose)


def open_subscription(
    node: Node,
    topic: str,
    publishers: TopicPublishers,
    quality: Quality,
    callback: Callable[[bytes], None],
    group: CallbackGroup | None = None,
) -> tuple[Subscription, str]:
    """Subscribe to the bytes of a topic; returns its schema, too."""
    profile = requested(Quality.LATCHED_EVERY if publishers.latched else quality, object)
    if publishers.loose:
        profile.reliability = ReliabilityPolicy.BEST_EFFORT  # the only one that connects to all of them
    subscription = node.create_subscription(
        publishers.message_class, topic, callback, profile, callback_group=group, raw=True
    )
    reset_error()
    return subscription, find_schema(publishers.kind) or ""


def _bare_class_of(publisher: TopicEndpointInfo) -> type | None:
    package, name = split_type(str(publisher.topic_type))
    if not hasattr(publisher, "topic_type_hash"):  # Humble
        return None
    found: type = bare_class(package, name, bytes(publisher.topic_type_hash.value).hex())
    return found
