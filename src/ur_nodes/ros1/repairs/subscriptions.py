"""Keeping the subscribers of a node connected to their publishers, in place of what rospy does."""

from __future__ import annotations

import http.client
import logging
import threading
import time
import xmlrpc.client
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import rosgraph.network
import rospy
from rospy.exceptions import TransportInitError
from rospy.impl import registration, tcpros_base

from ur.robot.addresses import AddressCache
from ur_nodes.ros1.repairs.sockets import CONNECT_LIMIT
from ur_nodes.ros1.repairs.xml_rpc_links import BoundedTransport

TOPIC_LIMIT = 5.0  # s for a publisher that the network reaches to answer which port has a topic
FIRST_PAUSE, LONGEST_PAUSE = 0.1, 0.5  # s between two tries to connect

if TYPE_CHECKING:
    from rospy.impl.masterslave import ROSHandler
    from rospy.impl.tcpros_base import TCPROSTransport

    Receive = Callable[[list[Any], TCPROSTransport], None]

_log = logging.getLogger("rosout")


class Subscriptions:
    """Keeps this node's subscribers connected to their publishers."""

    def __init__(self, addresses: AddressCache) -> None:
        self._addresses = addresses
        self._lock = threading.Lock()
        self._connecting: set[tuple[str, str]] = set()
        self._publishers: dict[str, frozenset[str]] = {}
        self._registering = False
        self._handler: ROSHandler | None = None

    def note_publishers(self, topic: str, uris: Iterable[str]) -> None:
        """Keep the publishers of a topic that the master names."""
        self._publishers[topic] = frozenset(map(str, uris))

    def connect_topic(self, handler: ROSHandler, topic: str, uri: str) -> tuple[int, str, int]:
        """Connect a topic to a publisher, in place of ROSHandler._connect_topic, and retry while that can succeed.

        It cannot once the publisher refuses, the master no longer names it, or there is no subscriber.
        """
        self._handler = handler
        key = (topic, uri)
        with self._lock:
            if key in self._connecting:
                return 1, f"{uri} is being asked for {topic} already", 0
            self._connecting.add(key)
        try:
            return self._negotiate(handler, topic, uri)
        finally:
            with self._lock:
                self._connecting.discard(key)

    def serve(
        self,
        connection: TCPROSTransport,
        address: str,
        port: int,
        uri: str,
        receive: Callable[[list[Any], TCPROSTransport], None],
        topic: str,
    ) -> None:
        """Receive from a new connection until it ends, then connect again; runs for the whole life of its thread.

        In place of tcpros_pubsub.robust_connect_subscriber.
        """
        began = time.monotonic()
        try:
            connection.connect(address, port, uri, timeout=CONNECT_LIMIT)
            connection.receive_loop(receive)
        except TransportInitError as problem:
            if not isinstance(problem.__context__, (OSError, rosgraph.network.ROSHandshakeException)):
                return  # the publisher has refused: another type, or no such topic
        finally:
            connection.close()
        if time.monotonic() - began < 1.0:
            time.sleep(LONGEST_PAUSE)
        if self._handler is not None and self._is_wanted(topic, uri):
            self.connect_topic(self._handler, topic, uri)
            if not self._is_local(uri):
                self._register_again()

    def _negotiate(self, handler: ROSHandler, topic: str, uri: str) -> tuple[int, str, int]:
        pause = FIRST_PAUSE
        while self._is_wanted(topic, uri):
            try:
                code, message, choice = self._request_topic(topic, uri)
            except ConnectionRefusedError as problem:
                if not self._moved(uri):
                    return -1, str(problem), 0  # that node has ended
            except (OSError, http.client.HTTPException, xmlrpc.client.Error, TypeError, ValueError):
                pass
            else:
                if code <= 0 or not isinstance(choice, list) or not choice:
                    return int(code) if code <= 0 else 0, str(message), 0
                protocols = [each for each in handler.protocol_handlers or () if each.supports(choice[0])]
                if not protocols or not self._is_wanted(topic, uri):
                    return 0, f"{uri}: {choice!r} is not wanted", 0
                made: tuple[int, str, int] = protocols[0].create_transport(topic, uri, choice)
                return made
            time.sleep(pause)
            pause = min(2.0 * pause, LONGEST_PAUSE)
        return 1, f"{topic} from {uri} is connected, or not wanted any more", 0

    def _request_topic(self, topic: str, uri: str) -> Any:
        transport = BoundedTransport(
            self._addresses, rospy.core.is_shutdown_requested, answer_limit=TOPIC_LIMIT, patience=0.0
        )
        with xmlrpc.client.ServerProxy(uri, transport=transport) as node:
            return node.requestTopic(rospy.names.get_caller_id(), topic, [[tcpros_base.TCPROS]])

    def _is_wanted(self, topic: str, uri: str) -> bool:
        subscriber = registration.get_topic_manager().get_subscriber_impl(topic)
        if rospy.core.is_shutdown_requested() or subscriber is None or subscriber.closed:
            return False
        if uri not in self._publishers.get(topic, {uri}):
            return False
        with subscriber.c_lock:
            return not subscriber.has_connection(uri)

    def _is_local(self, uri: str) -> bool:
        try:
            return bool(rosgraph.network.is_local_address(self._addresses.find(urlsplit(uri).hostname or "")))
        except OSError:
            return False

    def _moved(self, uri: str) -> bool:
        try:
            return self._addresses.refresh(urlsplit(uri).hostname or "")
        except OSError:
            return False

    def _register_again(self) -> None:
        """Ask the master for the publishers of all topics, soon: what it sent during a cut is lost."""
        with self._lock:
            if self._registering:
                return
            self._registering = True
        threading.Thread(target=self._register, name="register again", daemon=True).start()

    def _register(self) -> None:
        time.sleep(LONGEST_PAUSE)  # most topics end and come back together
        with self._lock:
            self._registering = False
        assert self._handler is not None, "a topic was connected"
        manager, node = self._handler.reg_man, rospy.names.get_caller_id()
        master = rospy.core.xmlrpcapi(manager.master_uri)
        for topic, kind in registration.get_topic_manager().get_subscriptions():
            if rospy.core.is_shutdown_requested() or not registration.get_topic_manager().has_subscription(topic):
                continue
            try:
                code, _, uris = master.registerSubscriber(node, topic, kind, manager.uri)
            except (OSError, http.client.HTTPException, xmlrpc.client.Error) as problem:
                _log.debug("the master at %s does not answer: %s", manager.master_uri, problem)
                return
            if code == 1:
                manager.publisher_update(topic, uris)
            if not registration.get_topic_manager().has_subscription(topic):  # it was given up meanwhile
                master.unregisterSubscriber(node, topic, manager.uri)
