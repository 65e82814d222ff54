import socket
from typing import Any

def service_connection_handler(sock: socket.socket, client_addr: Any, header: dict[str, str]) -> str | None: ...
