"""Heads of HTTP requests, parsed as far as needed to distinguish logged-in clients from others. No I/O.

The HTTP server parses them again. This module only decides how much of the server's time a connection gets.
"""

import re
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
