"""Bounds for rospy's connections: a node sees its topics again within 2 s of the return of a network that was cut.

rospy waits for its peers as if networks were never cut:

- Sockets have the kernel's limits: 15 minutes for what was sent, 60 s and more before a silent publisher is noticed.
  So messages of before a cut arrive after it, even those of a program that ended during it.
- A subscriber tries a lost publisher again after 1, 2, 4, ... 32 s, each time for up to 60 s; and when a connection
  *ends*, it does not try at all until the master names the publisher anew.
- XML-RPC calls between nodes and to the master have no limit.

This module replaces those few functions of rospy, in this process only, and sets limits on the sockets that it makes;
all else stays rospy's. `bound_connections` must be called before `rospy.init_node`. It fits rospy 1.15 to 1.17.

A publisher limits its connection to a subscriber only where that is safe: to one that connects again, and for what
moves a robot, which must not arrive late. Subscribers of ours declare in the header of their connection that they
connect again. Those of roscpp do, too, such as RViz, once they are notified that the connection has ended (see
`half_open`). Those of a plain rospy do not; TCP itself brings their connections back, later.
"""

import logging
import socket
import threading
import time
import weakref
import xmlrpc.client
from typing import Any

import rosgraph.network
import rosgraph.xmlrpc
import rospy
from rospy.exceptions import TransportInitError, TransportTerminated
from rospy.impl import masterslave, registration, tcpros_base, tcpros_pubsub, tcpros_service
from rospy.impl.transport import INBOUND

from ur.robot.addresses import AddressCache
from ur_nodes.ros1.repairs.sockets import (
    is_link_trouble,
    is_remote,
    limit_sending,
    limit_waiting,
    unless_abandoned,
    watch_peer,
)
from ur_nodes.ros1.repairs.subscriptions import Subscriptions
from ur_nodes.ros1.repairs.xml_rpc_links import BoundedTransport

LIMIT = 180.0  # s; by then the peer's own kernel has noticed: roscpp has it ask from 60 s on
PAUSE = 0.25  # s between two requests
_QUESTION = 0.25  # s for an answer


def share_port(server: socket.socket) -> None:
    """Allow further sockets on the port of a listening one, which `end_half_open` needs."""
    server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)


def end_half_open(
    local: tuple[str | int, ...], peer: tuple[str | int, ...], over: threading.Event, family: int = socket.AF_INET
) -> bool:
    """Reset the peer's end of a connection that has ended here, as soon as the network allows it.

    True once the peer answers that it has no such connection. False when it never answered, or `over` was set.
    """
    end = time.monotonic() + LIMIT
    while time.monotonic() < end and not over.is_set():
        with socket.socket(family, socket.SOCK_STREAM) as question:
            question.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            share_port(question)
            question.settimeout(_QUESTION)
            try:
                question.bind(local)
                question.connect(peer)
            except ConnectionRefusedError:
                return True
            except TimeoutError:
                continue
            except OSError:
                pass  # no network at all, for now
        over.wait(PAUSE)
    return False


HEADER_LIMIT = 5.0  # s for the headers that both ends of a connection exchange: a busy program is slow
SERVICE_LIMIT = 3.0  # s for a connection to a service, which is tried once
RECONNECTS = "ur_reconnects"  # the field in a subscriber's header: it connects again when a connection ends
COMMANDS = frozenset(
    {
        "geometry_msgs/PoseStamped",
        "geometry_msgs/PoseWithCovarianceStamped",
        "geometry_msgs/Twist",
        "geometry_msgs/TwistStamped",
        "move_base_msgs/MoveBaseActionGoal",
        "sensor_msgs/Joy",
    }
)
COMMAND_BUFFER = 4096  # bytes that the kernel keeps of commands (it doubles the figure for its own needs)

Address = tuple[str | int, ...]
Header = dict[str, str]
Transport = tcpros_base.TCPROSTransport
Ends = weakref.WeakKeyDictionary[socket.socket, tuple[Address, Address]]
"""Connections: their own address, and the peer's."""

_log = logging.getLogger("rosout")
_REPLACED: tuple[tuple[object, str], ...] = (
    (masterslave.ROSHandler, "_connect_topic"),
    (masterslave.ROSHandler, "publisherUpdate"),
    (registration, "get_topic_manager"),
    (registration.RegManager, "publisher_update"),
    (rosgraph.xmlrpc, "SilenceableXMLRPCRequestHandler"),
    (rospy.core, "is_shutdown_requested"),
    (rospy.core, "xmlrpcapi"),
    (tcpros_base.TCPServer, "_create_server_sock"),
    (tcpros_base.TCPROSServer, "_tcp_server_callback"),
    (tcpros_base.TCPROSTransport, "_reconnect"),
    (tcpros_base.TCPROSTransport, "connect"),
    (tcpros_base.TCPROSTransport, "receive_loop"),
    (tcpros_base.TCPROSTransport, "write_header"),
    (tcpros_pubsub, "robust_connect_subscriber"),
    (tcpros_pubsub.TCPROSHandler, "topic_connection_handler"),
    (tcpros_pubsub.TCPROSSub, "get_header_fields"),
    (tcpros_service, "service_connection_handler"),
)


def bound_connections() -> bool:
    """Bound the connections of this process's node. Return False, with a log line, for an unsupported rospy.

    Calling it again changes nothing.
    """
    if getattr(getattr(tcpros_pubsub, "robust_connect_subscriber", None), "bounded", False):
        return True
    missing = [name for owner, name in _REPLACED if not hasattr(owner, name)]
    if missing or not hasattr(socket, "TCP_USER_TIMEOUT"):
        _log.warning(
            "connections have no time limits: this rospy has no %s; after a cut of the network, topics are received "
            "again late. Please report it",
            ", ".join(missing) or "TCP_USER_TIMEOUT",
        )
        return False
    addresses = AddressCache(str) if rosgraph.network.use_ipv6() else AddressCache()
    subscriptions = Subscriptions(addresses)
    _bound_xml_rpc(addresses)
    _bound_transport(addresses)
    notified: Ends = weakref.WeakKeyDictionary()
    _bound_publishers(notified)
    _notify_peers(notified)
    _connect_subscribers_with(subscriptions)
    return True


def _bound_xml_rpc(addresses: AddressCache) -> None:
    """Bound all callers that rospy makes from now on, and those that this node's own server answers."""
    handler = rosgraph.xmlrpc.SilenceableXMLRPCRequestHandler
    set_up = handler.setup

    def setup(self: rosgraph.xmlrpc.SilenceableXMLRPCRequestHandler) -> None:
        set_up(self)
        _bound_inbound(self.connection)

    class OwnTransport(BoundedTransport):
        def __init__(self, **options: Any) -> None:
            super().__init__(addresses, rospy.core.is_shutdown_requested, **options)

    _replace(xmlrpc.client, "Transport", OwnTransport)
    _replace(handler, "setup", setup)


def _bound_transport(addresses: AddressCache) -> None:
    """Bound connections that this node makes: to publishers and to services."""
    transport = tcpros_base.TCPROSTransport
    connect, write_header = transport.connect, transport.write_header

    def bounded_connect(self: Transport, address: str, port: int, endpoint: str, timeout: float | None = None) -> None:
        try:
            known = addresses.find(address)
        except OSError:
            known = address  # rospy reports an unknown name
        try:
            connect(self, known, port, endpoint, timeout=min(timeout or SERVICE_LIMIT, SERVICE_LIMIT))
        except TransportInitError:
            self.close()
            raise
        if self.socket is not None:
            limit_waiting(self.socket, 0.0)

    def bounded_write_header(self: Transport) -> None:
        sock = self.socket
        if sock is not None and self.dest_address is not None:  # else a publisher's: its bounds are set already
            limit_waiting(sock, HEADER_LIMIT)
            if is_remote(sock):
                watch_peer(sock)
                if self.direction != INBOUND:
                    limit_sending(sock)
        write_header(self)

    def reconnect(self: Transport) -> None:
        raise TransportTerminated(f"{self.name}: the connection is lost")  # `Subscriptions.serve` makes a new one

    _replace(transport, "connect", bounded_connect)
    _replace(transport, "write_header", bounded_write_header)
    _replace(transport, "_reconnect", reconnect)


def _bound_publishers(notified: Ends) -> None:
    """Bound connections of subscribers and of service callers; those of roscpp go to `notified`."""
    server, handler = tcpros_base.TCPROSServer, tcpros_pubsub.TCPROSHandler
    accept = unless_abandoned(getattr(server, "_tcp_server_callback"))  # noqa: B009
    accept_topic = handler.topic_connection_handler
    accept_call = tcpros_service.service_connection_handler

    def bounded_accept(self: tcpros_base.TCPROSServer, sock: socket.socket, address: Address) -> None:
        limit_waiting(sock, HEADER_LIMIT)
        if is_remote(sock):  # rospy accepts one after the other: none may wait for another's lost header
            threading.Thread(target=accept, args=(self, sock, address), name="accept", daemon=True).start()
        else:
            accept(self, sock, address)

    def bounded_accept_topic(
        self: tcpros_pubsub.TCPROSHandler, sock: socket.socket, address: Address, header: Header
    ) -> str | None:
        limit_waiting(sock, 0.0)
        name = header.get("topic")
        topic = registration.get_topic_manager().get_publisher_impl(name) if name else None
        if topic is not None and is_remote(sock):
            command = getattr(topic.data_class, "_type", "") in COMMANDS
            if command or header.get(RECONNECTS) or _is_roscpp(header):
                watch_peer(sock)
                limit_sending(sock)
            if _is_roscpp(header):
                notified[sock] = (sock.getsockname(), sock.getpeername())
            if command and topic.queue_size is not None:  # else the program itself would wait for the network
                sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, COMMAND_BUFFER)
        return accept_topic(self, sock, address, header)

    def bounded_accept_call(sock: socket.socket, address: Address, header: Header) -> str | None:
        limit_waiting(sock, 0.0)
        _bound_inbound(sock)
        return accept_call(sock, address, header)

    _replace(server, "_tcp_server_callback", bounded_accept)
    _replace(tcpros_service, "service_connection_handler", bounded_accept_call)
    _replace(handler, "topic_connection_handler", bounded_accept_topic)


def _notify_peers(notified: Ends) -> None:
    """Notify subscribers, once the network has returned, that their connections (`notified`) ended during the cut."""
    server, transport = tcpros_base.TCPServer, tcpros_base.TCPROSTransport
    create, close = getattr(server, "_create_server_sock"), transport.close  # noqa: B009
    write = transport.write_data

    def create_shared(self: tcpros_base.TCPServer) -> socket.socket:
        listener: socket.socket = create(self)
        share_port(listener)
        return listener

    def noting_write(self: Transport, data: bytes) -> bool:
        try:
            return write(self, data)
        except OSError as problem:
            if is_link_trouble(problem) and self.socket is not None:
                lost.add(self.socket)
            raise

    def notifying_close(self: Transport) -> None:
        sock = self.socket
        ends = None if sock is None else notified.pop(sock, None)
        is_lost = sock is not None and ends is not None and (sock in lost or _has_link_trouble(sock))
        close(self)
        if ends is not None and is_lost and not over.is_set():
            threading.Thread(target=end_half_open, args=(*ends, over), name="half open", daemon=True).start()

    over = threading.Event()
    lost: weakref.WeakSet[socket.socket] = weakref.WeakSet()
    rospy.core.add_preshutdown_hook(lambda _reason: over.set())
    _replace(server, "_create_server_sock", create_shared)
    _replace(transport, "write_data", noting_write)
    _replace(transport, "close", notifying_close)


def _is_roscpp(header: Header) -> bool:
    return "message_definition" not in header  # rospy sends it


def _has_link_trouble(sock: socket.socket) -> bool:
    try:
        code = sock.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
    except OSError:
        return False
    return is_link_trouble(OSError(code, ""))


def _connect_subscribers_with(subscriptions: Subscriptions) -> None:
    handler, manager, subscriber = masterslave.ROSHandler, registration.RegManager, tcpros_pubsub.TCPROSSub
    update, note, fields = handler.publisherUpdate, manager.publisher_update, subscriber.get_header_fields

    def publisher_update(
        self: masterslave.ROSHandler, caller: str, topic: str, uris: list[str]
    ) -> tuple[int, str, int]:
        answer = update(self, caller, topic, uris)
        if answer[0] == 1:
            subscriptions.note_publishers(topic, uris)  # rospy notes nothing when there are none left
        return answer

    def note_update(self: registration.RegManager, topic: str, uris: list[str]) -> None:
        subscriptions.note_publishers(topic, uris)
        note(self, topic, uris)

    def header_fields(self: tcpros_pubsub.TCPROSSub) -> dict[str, str]:
        return {**fields(self), RECONNECTS: "1"}

    def connect_topic(self: masterslave.ROSHandler, topic: str, uri: str) -> tuple[int, str, int]:
        return subscriptions.connect_topic(self, topic, uri)

    def serve(*arguments: Any) -> None:
        subscriptions.serve(*arguments)

    serve.bounded = True  # type: ignore[attr-defined]
    _replace(handler, "publisherUpdate", publisher_update)
    _replace(handler, "_connect_topic", connect_topic)
    _replace(manager, "publisher_update", note_update)
    _replace(subscriber, "get_header_fields", header_fields)
    _replace(tcpros_pubsub, "robust_connect_subscriber", serve)


def _bound_inbound(sock: socket.socket) -> None:
    if is_remote(sock):
        watch_peer(sock)
        limit_sending(sock)


def _replace(owner: object, name: str, own: object) -> None:
    setattr(owner, name, own)
