import threading
from collections.abc import Callable
from typing import Any

import genpy
from rospy.impl.tcpros_base import TCPROSTransport

class SubscribeListener:
    def peer_subscribe(
        self, topic_name: str, topic_publish: Callable[[Any], None], peer_publish: Callable[[Any], None]
    ) -> None: ...
    def peer_unsubscribe(self, topic_name: str, num_peers: int) -> None: ...

class Topic:
    name: str
    type: str
    resolved_name: str
    def unregister(self) -> None: ...
    def get_num_connections(self) -> int: ...

class _TopicImpl:
    data_class: type[genpy.Message]
    connections: list[TCPROSTransport]
    queue_size: int | None
    def acquire(self) -> None: ...
    def release(self) -> None: ...
    def has_connection(self, endpoint_id: str) -> bool: ...

class _PublisherImpl(_TopicImpl):
    def add_subscriber_listener(self, l: SubscribeListener) -> None: ...

class _SubscriberImpl(_TopicImpl):
    closed: bool
    c_lock: threading.RLock
    def add_callback(self, cb: Callable[[Any, Any], object], cb_args: object) -> None: ...

class Publisher(Topic):
    impl: _PublisherImpl
    def __init__(
        self,
        name: str,
        data_class: type[genpy.Message],
        subscriber_listener: SubscribeListener | None = ...,
        tcp_nodelay: bool = ...,
        latch: bool = ...,
        headers: dict[str, str] | None = ...,
        queue_size: int | None = ...,
    ) -> None: ...
    def publish(self, *args: object, **kwds: object) -> None: ...

class Subscriber(Topic):
    impl: _SubscriberImpl
    def __init__(
        self,
        name: str,
        data_class: type[genpy.Message],
        callback: Callable[..., object] | None = ...,
        callback_args: object = ...,
        queue_size: int | None = ...,
        buff_size: int = ...,
        tcp_nodelay: bool = ...,
    ) -> None: ...

class _TopicManager:
    pubs: dict[str, _PublisherImpl]
    subs: dict[str, _SubscriberImpl]
    def get_subscriptions(self) -> list[tuple[str, str]]: ...
    def has_subscription(self, resolved_name: str) -> bool: ...
    def get_publisher_impl(self, resolved_name: str) -> _PublisherImpl | None: ...
    def get_subscriber_impl(self, resolved_name: str) -> _SubscriberImpl | None: ...

def get_topic_manager() -> _TopicManager: ...
