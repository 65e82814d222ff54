"""XML-RPC as the ROS master speaks it (http://xmlrpc.com/spec.md), without the standard library's HTTP stack.

`http.client` alone costs a third of the start-up time of `ur launch`. Values are sent as `xmlrpc.client` sends them,
which is what roslaunch uses; a test compares the two. A server that sends slowly, or without end, delays a call by the
timeout at most.
"""

import socket
import time
from base64 import b64decode, b64encode
from collections.abc import Callable
from typing import Any
from xml.parsers import expat

MAXINT = 2**31 - 1
MAX_ANSWER = 16 * 1024 * 1024  # bytes; all parameters of a large robot are some
MAX_HEAD = 64 * 1024
MAX_VALUES = 500_000
MAX_DEPTH = 100
_SLICE = 256 * 1024  # bytes between two checks of the clock


class Unanswered(Exception):  # noqa: N818 - says what happened
    """No answer, or an invalid one, from this address. The text describes the failure."""


class WrongServer(Unanswered):
    """A server accepts connections at this address, and its answer, if any, is not the expected one."""


class SilentServer(WrongServer):
    """A server accepted the connection, and has not answered in time. It may also be busy."""


class CallRefused(Exception):  # noqa: N818 - says what happened
    """The server answered with a fault or a failure code."""


def call_method(address: tuple[str, int], method: str, arguments: list[object], timeout: float) -> Any:
    """Call one method and return its result, all within `timeout` s.

    Raises Unanswered, CallRefused, or ValueError for an argument.
    """
    body = f"<?xml version='1.0'?>\n<methodCall>\n<methodName>{method}</methodName>\n<params>\n"
    body += "".join(f"<param>\n{dump_value(value)}</param>\n" for value in arguments)
    deadline = time.monotonic() + timeout
    try:
        return parse_response(_post(address, (body + "</params>\n</methodCall>\n").encode("utf-8"), timeout), deadline)
    except TimeoutError:
        raise WrongServer(f"the answer cannot be read within {timeout:g} s") from None


def dump_value(value: object) -> str:
    """Encode a value as XML.

    Raises ValueError for values that XML-RPC does not support: None, integers beyond 32 bits.
    """
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


def parse_response(data: bytes, deadline: float | None = None, clock: Callable[[], float] = time.monotonic) -> object:
    """Decode the result of a response, before `deadline` on the clock (s).

    Raises CallRefused for a fault, Unanswered for an invalid response, TimeoutError for one that takes too long to
    decode.
    """
    reader = _Reader()
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.text
    parser.EntityDeclHandler = _refuse_entity
    try:
        for start in range(0, len(data), _SLICE):
            parser.Parse(data[start : start + _SLICE], False)
            if deadline is not None:
                _left(deadline, clock)
        parser.Parse(b"", True)
    except (expat.ExpatError, ValueError, IndexError, TypeError) as problem:
        raise WrongServer(f"the answer is not XML-RPC: {problem}") from None
    if reader.fault:
        what = reader.values[0] if reader.values else {}
        raise CallRefused(str(what.get("faultString", what)) if isinstance(what, dict) else str(what))
    if not reader.values:
        raise WrongServer("the answer holds no value")
    return reader.values[0]


def _refuse_entity(*_: object) -> None:
    raise ValueError("an entity is declared")  # entities, which may expand beyond the memory


class _Reader:
    def __init__(self) -> None:
        self.values: list[object] = []
        self.fault = False
        self._marks: list[int] = []
        self._data: list[str] = []
        self._typed = False
        self._count = 0

    def start(self, tag: str, _: dict[str, str]) -> None:
        if tag in ("array", "struct"):
            self._marks.append(len(self.values))
            if len(self._marks) > MAX_DEPTH:
                raise ValueError("nested too deep")
        self._data = []
        if tag == "value":
            self._typed = False
            self._count += 1
            if self._count > MAX_VALUES:
                raise ValueError(f"more than {MAX_VALUES:,} values")
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


_SCALARS: dict[str, Callable[[str], object]] = {
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
    place = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
    head = f"POST /RPC2 HTTP/1.0\r\nHost: {place}\r\nContent-Type: text/xml\r\nContent-Length: {len(body)}\r\n\r\n"
    deadline = time.monotonic() + timeout
    late: type[Unanswered] = Unanswered
    try:
        with _connect(host, port, deadline) as link:
            late = SilentServer
            link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            link.settimeout(_left(deadline))
            link.sendall(head.encode("ascii") + body)
            return _read_answer(link, deadline)
    except TimeoutError:
        raise late(f"{place} did not answer within {timeout:g} s") from None
    except OSError as problem:
        raise Unanswered(f"{place}: {(problem.strerror or str(problem)).lower()}") from None
    except UnicodeError:
        raise Unanswered(f"{host!r} is not the name of a computer") from None


def _connect(host: str, port: int, deadline: float) -> socket.socket:
    problem: OSError = OSError("no address")
    plain = host.isascii() and all(0 < len(label) < 64 for label in host.split("."))
    name = host.encode() if plain else host  # IDNA, which takes 0.5 MB, is imported only for names that need it
    for family, kind, protocol, _, address in socket.getaddrinfo(name, port, type=socket.SOCK_STREAM):
        link = socket.socket(family, kind, protocol)
        try:
            link.settimeout(_left(deadline))
            link.connect(address)
        except OSError as reason:
            link.close()
            problem = reason
        else:
            return link
    raise problem


def _left(deadline: float, clock: Callable[[], float] = time.monotonic) -> float:
    left = deadline - clock()
    if left <= 0:
        raise TimeoutError
    return left


def _read_answer(link: socket.socket, deadline: float) -> bytes:
    data = bytearray()
    end = -1
    while end < 0:
        if len(data) > MAX_HEAD:
            raise WrongServer(f"expected a ROS master, got more than {MAX_HEAD:,} bytes without the end of a head")
        searched = max(0, len(data) - 3)
        if not _receive(link, deadline, data):
            raise Unanswered("the connection was closed before an answer arrived")
        end = data.find(b"\r\n\r\n", searched)
    status, *lines = data[:end].decode("latin-1").split("\r\n")
    if len(status.split()) < 2 or status.split()[1] != "200":
        raise WrongServer(f"expected a ROS master, got {status[:80]!r}")
    headers = {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
    length = headers.get("content-length", "")
    size = int(length) if length.isascii() and length.isdigit() and len(length) < 12 else None
    del data[: end + 4]
    while size is None or len(data) < size:
        if max(len(data), size or 0) > MAX_ANSWER:
            raise WrongServer(f"the answer is larger than {MAX_ANSWER:,} bytes")
        if not _receive(link, deadline, data):
            break
    return bytes(data)


def _receive(link: socket.socket, deadline: float, data: bytearray) -> bool:
    link.settimeout(_left(deadline))
    part = link.recv(65536)
    data += part
    return bool(part)
