"""Publishers and subscriptions of installed messages, and of messages as bytes. See `codecs.bare`."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rclpy.node import Node, PublisherEventCallbacks
from rclpy.qos import QoSProfile

from ur.source.diagnostic import user_error
from ur_nodes.ros2.messages.bare_type import bare_class, reset_error

if TYPE_CHECKING:
    from rclpy.event_handler import MatchedInfo

_LOOK = 0.1  # s between two counts of subscribers, where the middleware reports none
_REPORTS_MATCHES = "matched" in inspect.signature(PublisherEventCallbacks).parameters  # not in Humble


class MessageSender:
    """Sends messages; `on_subscriber` is called, on any thread, for each new subscriber."""

    def __init__(
        self,
        node: Node,
        message_class: Any,
        topic: str,
        profile: QoSProfile,
        on_subscriber: Callable[[], None] | None = None,
    ) -> None:
        def matched(event: MatchedInfo) -> None:
            if on_subscriber is not None and event.current_count_change > 0:
                on_subscriber()

        reports = on_subscriber is not None and _REPORTS_MATCHES
        callbacks = PublisherEventCallbacks(matched=matched) if reports else None
        self._bare = hasattr(message_class, "BARE")
        self._node = node
        with _type_of(message_class) as kind:
            self._publisher = node.create_publisher(kind, topic, profile, event_callbacks=callbacks)
        self._looks = None
        if on_subscriber is not None and not reports:
            self._looks = node.create_timer(_LOOK, counter(self.subscribers, on_subscriber))

    def send(self, message: Any) -> None:
        """Send a message, or its bytes."""
        written = self._bare and not isinstance(message, bytes)
        self._publisher.publish(message.write() if written else message)

    def subscribers(self) -> int:
        """The number of subscribers."""
        return int(self._publisher.get_subscription_count())

    def close(self) -> None:
        """Stop sending."""
        if self._looks is not None:
            self._node.destroy_timer(self._looks)
        self._node.destroy_publisher(self._publisher)


def counter(count: Callable[[], int], on_subscriber: Callable[[], None]) -> Callable[[], None]:
    """Return a function, to be called regularly, that reports when there are more subscribers than at its last call."""
    known = [0]

    def look() -> None:
        before, known[0] = known[0], count()
        if known[0] > before:
            on_subscriber()

    return look


class Receiver:
    """Receives messages, on the spinning thread.

    Invalid messages are reported and dropped. `callback_from` gets messages with the middleware's information about
    them, instead of `callback`. With `raw` they are bytes.
    """

    def __init__(
        self,
        node: Node,
        message_class: Any,
        topic: str,
        profile: QoSProfile,
        callback: Callable[[Any], None],
        callback_from: Callable[[Any, Mapping[str, Any]], None] | None = None,
        *,
        raw: bool = False,
    ) -> None:
        def read(data: bytes) -> None:
            try:
                message = message_class.read(data)
            except ValueError as problem:
                node.get_logger().error(f"{topic}: {problem}", throttle_duration_sec=10.0)
            else:
                callback(message)

        bare = hasattr(message_class, "BARE")
        self._node = node
        call = read if bare else callback_from or callback
        with _type_of(message_class) as kind:
            self._subscription = node.create_subscription(kind, topic, call, profile, raw=raw or bare)

    def publishers(self) -> int:
        """The number of publishers."""
        return int(self._node.count_publishers(self._subscription.topic_name))

    def close(self) -> None:
        """Stop receiving."""
        self._node.destroy_subscription(self._subscription)


@contextmanager
def _type_of(message_class: Any) -> Iterator[Any]:
    """Return rclpy's type of a message, for a publisher or subscription.

    Raises UserError if it is needed and missing.
    """
    if not hasattr(message_class, "BARE"):
        yield message_class
        return
    package, name, _ = message_class.BARE
    try:
        yield bare_class(*message_class.BARE)
    except (OSError, RuntimeError) as problem:
        distro = os.environ.get("ROS_DISTRO", "DISTRO")
        raise user_error(
            f"ROS 2 {distro.capitalize()} has no {package}, expected it for messages of the type {package}/{name}",
            rule="missing-messages",
            help=f"sudo apt install ros-{distro}-{package.replace('_', '-')}",
        ) from problem
    finally:
        reset_error()
