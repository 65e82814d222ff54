"""Bounds for TCP connections between two computers: how long one may wait for a peer that the network has lost.

Linux keeps a connection whose peer is silent for 15 minutes, and tries again ever more rarely: after a cut of 30 s it
waits up to 30 s more although the network is back. And it delivers then what was written during the cut, even for a
program that has ended meanwhile. With these bounds a connection across a cut network ends within a few seconds, with
what was queued in it, so that a new one can be made as soon as the network is back.

Connections within one computer are left alone: there is no network between them, and a peer that is slow for a second
must not lose them.
"""

import contextlib
import errno
import ipaddress
import socket
import struct
from collections.abc import Callable

KEEPALIVE_IDLE = 1  # s without data before the kernel asks the peer
KEEPALIVE_INTERVAL = 1  # s between two such questions
KEEPALIVE_PROBES = 2  # unanswered questions that end the connection
SEND_LIMIT = 1.0  # s that sent data may stay unacknowledged
CONNECT_LIMIT = 1.0  # s for a connection to be made

Address = tuple[str | int, ...]

_LINK_TROUBLE = frozenset(
    {errno.ETIMEDOUT, errno.EHOSTUNREACH, errno.EHOSTDOWN, errno.ENETUNREACH, errno.ENETDOWN, errno.ENETRESET}
)


def is_remote(sock: socket.socket) -> bool:
    """Return whether the peer of a connected socket is another computer. False for a socket that is not connected."""
    try:
        peer, own = str(sock.getpeername()[0]), str(sock.getsockname()[0])
    except (OSError, IndexError):
        return False
    return peer != own and not _is_loopback(peer)


def watch_peer(sock: socket.socket) -> None:
    """End the connection when the peer has answered nothing for 3 s, also while there is nothing to send."""
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, KEEPALIVE_IDLE)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, KEEPALIVE_INTERVAL)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, KEEPALIVE_PROBES)


def limit_sending(sock: socket.socket, seconds: float = SEND_LIMIT) -> None:
    """End the connection when sent data stay unacknowledged this long.

    The bound holds for what the kernel still sends after the program has ended, too.
    """
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, int(seconds * 1000))


def limit_waiting(sock: socket.socket, seconds: float) -> None:
    """Let a blocking read or write fail with EAGAIN after this time; 0 removes the limit."""
    for layout in ("ll", "qq"):  # 32-bit systems have either, as their C library was built
        value = struct.pack(layout, int(seconds), int(seconds % 1 * 1e6))
        with contextlib.suppress(OSError):  # the next read of the closed socket fails
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, value)
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, value)
            return


def is_abandoned(sock: socket.socket) -> bool:
    """Wait for the first byte; return whether the peer ended the connection before it, as a program that ends does."""
    try:
        return not sock.recv(1, socket.MSG_PEEK)
    except ConnectionError:
        return True
    except OSError:  # nothing arrived in time
        return False


def unless_abandoned(accept: Callable[[object, socket.socket, Address], None]) -> Callable[..., None]:
    """Accept as `accept` does, but close an abandoned connection in silence: rospy warns of it, with a traceback."""

    def accept_or_close(server: object, sock: socket.socket, address: Address) -> None:
        if is_abandoned(sock):
            sock.close()
        else:
            accept(server, sock, address)

    return accept_or_close


def is_link_trouble(problem: BaseException | None) -> bool:
    """Return whether an error means that the network lost the peer, rather than that the peer refused."""
    return isinstance(problem, OSError) and (isinstance(problem, TimeoutError) or problem.errno in _LINK_TROUBLE)


def _is_loopback(address: str) -> bool:
    try:
        return ipaddress.ip_address(address.partition("%")[0]).is_loopback
    except ValueError:
        return False
