"""Hosts and origins that requests may name: the defence against DNS rebinding and against pages of other sites.

A browser that shows another site sends that site's name as Host (DNS rebinding) or as Origin (cross-site request).
Programs may send no Origin, so it is required only for changes and for opening a web socket.
"""

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass

LONGEST = 32768
"""Bytes of the longest head. The cookies of all servers of one host are in it, of all their ports."""

_END = b"\r\n\r\n"
_LENGTH = re.compile(rb"\r\ncontent-length:[ \t]*(\d{1,9})[ \t]*(?=\r\n)", re.IGNORECASE)
_ENCODING = re.compile(rb"\r\ntransfer-encoding:", re.IGNORECASE)
_COOKIES = re.compile(rb"\r\ncookie:([^\r\n]*)", re.IGNORECASE)
_SECRET = re.compile(rb'"?([\w-]{1,128})"?(?=[ \t]*(?:;|$))', re.ASCII)
_MOST_COOKIES = 8
"""Cookies with the name of a session that are looked at in a head."""


@dataclass(frozen=True, slots=True)
class Head:
    """A request line with its headers, and the number of body bytes that they announce; None if unknown."""

    data: bytes
    body: int | None

    @property
    def target(self) -> bytes:
        """The path and query."""
        words = self.data.partition(b"\r\n")[0].split(b" ")
        return words[1] if len(words) == 3 else b""


def find_head(buffer: bytes | bytearray, before: int = 0) -> Head | None:
    """Parse the head at the beginning of a buffer whose first `before` bytes held no end; None if it is incomplete."""
    end = buffer.find(_END, max(0, before - len(_END) + 1))
    if end < 0:
        return None
    data = bytes(buffer[: end + len(_END)])
    lengths = _LENGTH.findall(data)
    if _ENCODING.search(data) or len(lengths) > 1:
        return Head(data, None)
    return Head(data, int(lengths[0]) if lengths else 0)


def find_cookies(head: Head, name: str) -> list[str]:
    """Return the values of the first few cookies with this name, in a time that grows with the head's length only."""
    wanted, found, looked_at = name.encode() + b"=", [], 0
    for line in _COOKIES.findall(head.data)[:_MOST_COOKIES]:
        at = line.find(wanted)
        while at >= 0 and looked_at < _MOST_COOKIES:
            looked_at += 1
            value = _SECRET.match(line, at + len(wanted))
            if value is not None and line[:at].rstrip(b" \t")[-1:] in (b"", b";"):
                found.append(value[1].decode())
            at = line.find(wanted, at + len(wanted))
    return found


_HOST = re.compile(r"(\[[0-9A-Fa-f:.]{2,45}\]|[0-9A-Za-z.-]{1,253})(?::(\d{1,5}))?", re.ASCII)
LOOPBACK = frozenset({"localhost", "127.0.0.1", "[::1]"})
VIEWER_ORIGINS = frozenset({"https://app.foxglove.dev", "file://"})
"""Origins of the pages of Foxglove, and of desktop programs whose page is a file of theirs (Lichtblick)."""


@dataclass(frozen=True, slots=True)
class Origins:
    """`names`: host names and addresses of this computer, in lower case; `port`: that of the server.

    The names of the loopback interface are valid with every port: `ssh -L` may have chosen another.
    """

    names: frozenset[str]
    port: int


def make_origins(names: Iterable[str], port: int) -> Origins:
    """Return the origins of a server with these names and addresses, besides those of the loopback interface."""
    return Origins(LOOPBACK | {_bracket(each.lower().rstrip(".")) for each in names if each}, port)


def allows_host(origins: Origins, host: str | None, address: str = "") -> bool:
    """Return whether a Host header names this server.

    `address` is the one that the request was sent to: it is valid as Host, because no other site can have it.
    """
    found = _HOST.fullmatch(host or "")
    if found is None:
        return False
    name, port = found[1].lower().rstrip("."), int(found[2] or 80)
    own = {_bracket(address.lower())} if address else set()
    return name in LOOPBACK or (name in origins.names | own and port == origins.port)


def allows_origin(host: str | None, origin: str | None) -> bool:
    """Return whether an Origin header is that of the server's page, loaded from this permitted Host."""
    return host is not None and origin is not None and origin == f"http://{host}"


def allows_viewer(host: str | None, origin: str | None, others: Collection[str] = ()) -> bool:
    """Return whether an Origin header is that of a viewer: this page, a known one, `others`, or of this computer.

    Programs other than browsers send none. The secret of the link is also required of all of them.
    """
    if origin is None or allows_origin(host, origin) or origin in VIEWER_ORIGINS or origin in others:
        return True
    found = _HOST.fullmatch(origin.removeprefix("http://"))
    return origin.startswith("http://") and found is not None and found[1].lower() in LOOPBACK


def read_origin(text: str) -> str | None:
    """Parse an origin as a user writes it to the form that browsers send; None if it is invalid."""
    scheme, _, rest = text.strip().lower().rstrip("/").partition("://")
    return f"{scheme}://{rest}" if scheme in ("http", "https") and _HOST.fullmatch(rest) else None


def _bracket(name: str) -> str:
    return f"[{name}]" if ":" in name and not name.startswith("[") else name
