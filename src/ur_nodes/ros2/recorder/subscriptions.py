"""Subscriptions of bytes: to topics of any type and of any quality."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy.qos import ReliabilityPolicy

from ur_nodes.ports.qualities import Quality
from ur_nodes.ros2.messages.bare_type import bare_class, reset_error
from ur_nodes.ros2.messages.definitions import find_class, find_schema, split_type
from ur_nodes.ros2.qualities import requested

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.node import Node, Subscription, TopicEndpointInfo


def open_subscription(
    node: Node, topic: str, quality: Quality, take: Callable[[bytes], None], group: CallbackGroup | None = None
) -> tuple[Subscription, str, str] | None:
    """Subscribe to the bytes of a topic; returns type and schema, too. None: no node publishes it, to give the type."""
    found = node.get_publishers_info_by_topic(topic)
    if not found:
        return None
    kind = str(found[0].topic_type)
    message_class = find_class(kind, "msg") or _bare_class_of(found[0])
    latched = all(each.qos_profile.durability.name == "TRANSIENT_LOCAL" for each in found)
    profile = requested(Quality.LATCHED_EVERY if latched else quality, object)
    if any(each.qos_profile.reliability.name == "BEST_EFFORT" for each in found):
        profile.reliability = ReliabilityPolicy.BEST_EFFORT  # the only one that connects to them
    subscription = node.create_subscription(message_class, topic, take, profile, callback_group=group, raw=True)
    reset_error()
    return subscription, kind, find_schema(kind, "msg") or ""


def _bare_class_of(publisher: TopicEndpointInfo) -> type:
    package, name = split_type(str(publisher.topic_type))
    found: type = bare_class(package, name, bytes(publisher.topic_type_hash.value).hex())
    return found
