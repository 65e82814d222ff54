"""A device behind a TCP port, as a lidar on Ethernet."""

import socket
from urllib.parse import urlsplit

from ur_nodes.drivers.lines.line import explain_error

SCHEME = "tcp://"
_PATIENCE = 2.0  # s until a device that does not answer is given up


def open_socket(address: str) -> socket.socket | str:
    """Connect to `tcp://HOST:PORT`; or why that failed. What is sent and not taken for _PATIENCE breaks the line."""
    try:
        parts = urlsplit(address)
        port = parts.port
        if not parts.hostname or port is None:
            return "no address of a device, expected tcp://HOST:PORT"
        connected = socket.create_connection((parts.hostname, port), timeout=_PATIENCE)
    except (OSError, ValueError) as problem:
        return "it does not answer" if isinstance(problem, TimeoutError) else explain_error(problem)
    connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, round(_PATIENCE * 1000))
    connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connected.setblocking(False)
    return connected
