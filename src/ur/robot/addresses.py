"""Cache of host name look-ups that keeps known addresses usable while the network is down."""

import ipaddress
import socket
import threading
import time
from collections.abc import Callable

REFRESH_PERIOD = 2.0  # s between two look-ups of a known name


class AddressCache:
    """Cache of the addresses of hosts.

    A look-up of a `.local` name takes 5 s to fail, and one that began during a cut answers only some seconds after it.
    So `find` returns a known address at once and refreshes it in the background.
    """

    def __init__(
        self, look_up: Callable[[str], str] | None = None, monotonic: Callable[[], float] = time.monotonic
    ) -> None:
        self._look_up = look_up or _look_up
        self._monotonic = monotonic
        self._known: dict[str, str] = {}
        self._asked: dict[str, float] = {}
        self._lock = threading.Lock()

    def find(self, host: str) -> str:
        """Return the address of a host.

        Raises OSError for a name that was never resolved and cannot be resolved now.
        """
        with self._lock:
            known = self._known.get(host)
            due = self._monotonic() - self._asked.get(host, -REFRESH_PERIOD) >= REFRESH_PERIOD
            if known and due:
                self._asked[host] = self._monotonic()
        if not known:
            self.refresh(host)
            return self._known[host]
        if due and not is_address(host):
            threading.Thread(target=self._try_refresh, args=(host,), name=f"address {host}", daemon=True).start()
        return known

    def refresh(self, host: str) -> bool:
        """Resolve a host name now and return whether its address has changed. Raises OSError."""
        address = self._look_up(host)
        with self._lock:
            before = self._known.get(host)
            self._known[host] = address
            self._asked[host] = self._monotonic()
        return before is not None and before != address

    def _try_refresh(self, host: str) -> None:
        try:
            self.refresh(host)
        except OSError:
            return  # the network may be down: the known address stays


def _look_up(host: str) -> str:
    if is_address(host):
        return host
    found = socket.getaddrinfo(host, None, socket.AF_INET, socket.SOCK_STREAM)
    return str(found[0][4][0])


def is_address(host: str) -> bool:
    """Return whether a host is given as an IP address."""
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True
