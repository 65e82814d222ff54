"""XML-RPC calls of a node that end when the network loses the peer.

`xmlrpc.client` waits without limit: for a connection, and for an answer that a cut network never brings. rospy makes
its callers in many places, all of them with the transport that `xmlrpc.client` names `Transport`.
"""

import errno
import http.client
import socket
import time
import xmlrpc.client
from collections.abc import Callable
from typing import Any, cast

from ur.robot.addresses import AddressCache
from ur_nodes.ros1.repairs.sockets import CONNECT_LIMIT, is_link_trouble, is_remote, limit_sending, watch_peer

ANSWER_LIMIT = 30.0  # s that a peer which the network reaches may take: a busy master is slow
END_LIMIT = 2.0  # s likewise at the end of a node, which asks for nothing: the master has the request all the same
PATIENCE = 10.0  # s for which a call is tried again while the network does not reach the peer
PAUSE = 0.2  # s between two tries


class BoundedConnection(http.client.HTTPConnection):
    """An HTTP connection with limits (s) on connecting, waiting and sending."""

    def __init__(self, host: str, addresses: AddressCache, answer_limit: float) -> None:
        super().__init__(host, timeout=answer_limit)
        self._addresses = addresses
        self._answer_limit = answer_limit

    def connect(self) -> None:
        """Connect within a second. Raises OSError, with ETIMEDOUT when there is no answer."""
        try:
            sock = socket.create_connection((self._addresses.find(self.host), self.port), CONNECT_LIMIT)
        except TimeoutError:
            raise TimeoutError(errno.ETIMEDOUT, f"{self.host}:{self.port} does not answer") from None
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if is_remote(sock):
            watch_peer(sock)
            limit_sending(sock)
        sock.settimeout(self._answer_limit)
        self.sock = sock

    def limit_answer(self, seconds: float) -> None:
        """Limit the wait for the next answer."""
        self._answer_limit = seconds
        if self.sock is not None:
            self.sock.settimeout(seconds)


class BoundedTransport(xmlrpc.client.Transport):
    """A transport for ServerProxy over bounded connections.

    A call that the network loses is tried again for `patience` (s), unless `is_ending()`. What nodes ask a master
    may be asked twice.
    """

    connection_class: type[BoundedConnection] = BoundedConnection

    def __init__(
        self,
        addresses: AddressCache,
        is_ending: Callable[[], bool],
        *,
        answer_limit: float = ANSWER_LIMIT,
        patience: float = PATIENCE,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        self._addresses = addresses
        self._is_ending = is_ending
        self._answer_limit = answer_limit
        self._patience = patience

    def make_connection(self, host: tuple[str, dict[str, str]] | str) -> http.client.HTTPConnection:
        """Make a bounded connection, kept for the next call as the standard library does."""
        limit = min(self._answer_limit, END_LIMIT) if self._is_ending() else self._answer_limit
        if self._connection[1] and host == self._connection[0]:
            kept = cast("BoundedConnection", self._connection[1])
            kept.limit_answer(limit)
            return kept
        name, self._extra_headers, _ = self.get_host_info(host)
        connection = self.connection_class(name, self._addresses, limit)
        self._connection = host, connection
        return connection

    def request(self, *arguments: Any, **options: Any) -> Any:
        """Send a request, again while the network loses it. Raises OSError and xmlrpc.client.Error."""
        end = time.monotonic() + self._patience
        while True:
            try:
                return super().request(*arguments, **options)
            except OSError as problem:
                lost = is_link_trouble(problem) and problem.errno is not None
                if not lost or self._is_ending() or time.monotonic() + PAUSE > end:
                    if isinstance(problem, TimeoutError) and problem.errno is None:  # rospy expects a number
                        raise TimeoutError(errno.ETIMEDOUT, "no answer in time") from None
                    raise
            time.sleep(PAUSE)
