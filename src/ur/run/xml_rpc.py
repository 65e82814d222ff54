"""XML-RPC as the ROS master speaks it (http://xmlrpc.com/spec.md), without the standard library's HTTP stack.

`http.client` alone costs a third of the start-up time of `ur launch`. Values are sent as `xmlrpc.client` sends them,
which is what roslaunch uses; a test compares the two.
"""

from __future__ import annotations

import socket
from base64 import b64decode, b64encode
from typing import Any
from xml.parsers import expat

MAXINT = 2**31 - 1


class Unanswered(Exception):  # noqa: N818 - says what happened
    """Nobody answers at this address, or the answer makes no sense. The text says what happened."""


class Refused(Exception):  # noqa: N818 - says what happened
    """The server answered with a fault or a failure code."""


def call_method(address: tuple[str, int], method: str, arguments: list[Any], timeout: float) -> Any:
    """Call one method and return its result. Raises Unanswered, Refused, or ValueError for an argument."""
    body = f"<?xml version='1.0'?>\n<methodCall>\n<methodName>{method}</methodName>\n<params>\n"
    body += "".join(f"<param>\n{dump_value(value)}</param>\n" for value in arguments)
    return parse_response(_post(address, (body + "</params>\n</methodCall>\n").encode("utf-8"), timeout))


def dump_value(value: Any) -> str:
    """A value as XML. Raises ValueError for what XML-RPC cannot carry: None, and integers beyond 32 bits."""
    if isinstance(value, bool):
        return f"<value><boolean>{int(value)}</boolean></value>\n"
    if isinstance(value, int):
        if not -MAXINT - 1 <= value <= MAXINT:
            raise ValueError(f"{value} is beyond 32 bits, which parameters cannot hold")
        return f"<value><int>{value}</int></value>\n"
    if isinstance(value, float):
        return f"<value><double>{value!r}</double></value>\n"
    if isinstance(value, str):
        return f"<value><string>{_escape(value)}</string></value>\n"
    if isinstance(value, bytes):
        return f"<value><base64>\n{b64encode(value).decode()}\n</base64></value>\n"
    if isinstance(value, (list, tuple)):
        return f"<value><array><data>\n{''.join(map(dump_value, value))}</data></array></value>\n"
    if isinstance(value, dict):
        members = "".join(
            f"<member>\n<name>{_escape(str(key))}</name>\n{dump_value(item)}</member>\n" for key, item in value.items()
        )
        return f"<value><struct>\n{members}</struct></value>\n"
    raise ValueError(f"{value!r} is nothing that parameters can hold")


def parse_response(data: bytes) -> Any:
    """The result in a response. Raises Refused for a fault, Unanswered for what is no response."""
    reader = _Reader()
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.text
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, ValueError, IndexError) as problem:
        raise Unanswered(f"the answer is not XML-RPC: {problem}") from None
    if reader.fault:
        what = reader.values[0] if reader.values else {}
        raise Refused(str(what.get("faultString", what)) if isinstance(what, dict) else str(what))
    if not reader.values:
        raise Unanswered("the answer holds no value")
    return reader.values[0]


class _Reader:
    def __init__(self) -> None:
        self.values: list[Any] = []
        self.fault = False
        self._marks: list[int] = []
        self._data: list[str] = []
        self._typed = False

    def start(self, tag: str, _: dict[str, str]) -> None:
        if tag in ("array", "struct"):
            self._marks.append(len(self.values))
        self._data = []
        if tag == "value":
            self._typed = False
        elif tag == "fault":
            self.fault = True

    def text(self, data: str) -> None:
        self._data.append(data)

    def end(self, tag: str) -> None:
        text = "".join(self._data)
        if tag == "value":
            if not self._typed:
                self.values.append(text)  # no type means a string
            self._data = []
            self._typed = True
        elif tag == "name":
            self.values.append(text)
        elif tag in ("array", "struct"):
            mark = self._marks.pop()
            items = self.values[mark:]
            self.values[mark:] = [items if tag == "array" else dict(zip(items[::2], items[1::2], strict=True))]
            self._typed = True
        elif tag in _SCALARS:
            self.values.append(_SCALARS[tag](text))
            self._typed = True


_SCALARS: dict[str, Any] = {
    "int": int,
    "i4": int,
    "i8": int,
    "boolean": lambda text: text.strip() == "1",
    "double": float,
    "string": str,
    "base64": b64decode,
    "nil": lambda _: None,
}


def _escape(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _post(address: tuple[str, int], body: bytes, timeout: float) -> bytes:
    host, port = address
    head = (
        f"POST /RPC2 HTTP/1.0\r\nHost: {host}:{port}\r\nContent-Type: text/xml\r\nContent-Length: {len(body)}\r\n\r\n"
    )
    try:
        with socket.create_connection(address, timeout) as link:
            link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            link.sendall(head.encode("ascii") + body)
            return _read_answer(link)
    except TimeoutError:
        raise Unanswered(f"{host}:{port} did not answer within {timeout:g} s") from None
    except OSError as problem:
        raise Unanswered(f"{host}:{port}: {(problem.strerror or str(problem)).lower()}") from None


def _read_answer(link: socket.socket) -> bytes:
    data = b""
    while b"\r\n\r\n" not in data:
        part = link.recv(65536)
        if not part:
            raise Unanswered("the connection was closed before an answer came")
        data += part
    head, _, body = data.partition(b"\r\n\r\n")
    status, *lines = head.decode("latin-1").split("\r\n")
    if len(status.split()) < 2 or status.split()[1] != "200":
        raise Unanswered(f"expected a ROS master, got {status[:80]!r}")
    headers = {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
    length = int(headers.get("content-length", "-1"))
    parts = [body]
    size = len(body)
    while length < 0 or size < length:
        part = link.recv(65536)
        if not part:
            break
        parts.append(part)
        size += len(part)
    return b"".join(parts)
