import socket
import threading
from collections.abc import Callable
from typing import Any

from rospy.impl.tcpros_base import TCPROSTransport

class TCPROSHandler:
    def topic_connection_handler(self, sock: socket.socket, client_addr: Any, header: dict[str, str]) -> str | None: ...

class TCPROSSub:
    def get_header_fields(self) -> dict[str, str]: ...

class QueuedConnection(TCPROSTransport):
    _connection: TCPROSTransport
    _queue_size: int
    _lock: threading.Lock
    _error: Exception | None
    _queue: list[bytes]
    _closed_connection_callback: Callable[[Any], None]
    def __init__(self, connection: Any, queue_size: int) -> None: ...
    _cond_data_available: threading.Condition

robust_connect_subscriber: Callable[..., None]
