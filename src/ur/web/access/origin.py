"""Hosts and origins that requests may name: the defence against DNS rebinding and against pages of other sites.

A browser that shows another site sends that site's name as Host (DNS rebinding) or as Origin (cross-site request).
Programs may send no Origin, so it is required only for changes and for opening a web socket.
"""

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass

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
