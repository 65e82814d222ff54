"""Robots on the network: who announces itself, and who took a name that another had first."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

SERVICE_TYPE = "_ubiquity-robot._tcp.local."


@dataclass(frozen=True, slots=True)
class Sighting:
    """A computer that announces itself. `host` is the name that its zeroconf daemon gave it, without .local.

    `name` is what its robot file says: the two differ when another computer had the name first. `version` is that of
    the `ur` that set it up.
    """

    host: str
    name: str
    addresses: tuple[str, ...]
    base: str = ""
    variant: str = ""
    user: str = ""
    version: str = ""

    @property
    def address(self) -> str:
        """The first IPv4 address, which ROS uses; '' where there is none."""
        return next((address for address in self.addresses if ":" not in address), "")


def parse_sighting(host: str, addresses: Sequence[str], texts: dict[str, str]) -> Sighting:
    """A sighting from an announcement's host name, addresses and text records."""
    host = host.rstrip(".").removesuffix(".local")
    base = re.sub(r"-\d+$", "", host)  # what avahi adds when a name is taken
    known = {key: texts.get(key, "") for key in ("base", "variant", "user", "version")}
    return Sighting(host, texts.get("name") or base, tuple(addresses), **known)


@dataclass(slots=True)
class Browser:
    """Listens for robots while it is open; use as a context manager. `changed` is called from another thread."""

    changed: Callable[[], None] = lambda: None
    _zeroconf: Any = None
    _seen: dict[str, Sighting] = field(default_factory=dict)

    def __enter__(self) -> Browser:
        from zeroconf import ServiceBrowser, Zeroconf

        self._zeroconf = Zeroconf()
        ServiceBrowser(self._zeroconf, SERVICE_TYPE, handlers=[self._notice])
        return self

    def __exit__(self, *_: object) -> None:
        self._zeroconf.close()

    @property
    def sightings(self) -> list[Sighting]:
        """Who is there now."""
        return list(self._seen.values())

    def find_twin(self, name: str, seconds: float) -> str:
        """The address of a computer to which zeroconf gave NAME-2 since NAME was taken; '' when nobody answers."""
        from zeroconf import AddressResolverIPv4

        resolver = AddressResolverIPv4(f"{name}-2.local.")
        if not resolver.request(self._zeroconf, seconds * 1000):
            return ""
        return next(iter(resolver.parsed_addresses()), "")

    def _notice(self, zeroconf: Any, service_type: str, name: str, state_change: Any) -> None:
        from zeroconf import ServiceStateChange

        if state_change is ServiceStateChange.Removed:
            self._seen.pop(name, None)
        else:
            info = zeroconf.get_service_info(service_type, name)
            if info is not None and info.server:
                texts = {
                    key.decode(): (value or b"").decode(errors="replace") for key, value in info.properties.items()
                }
                self._seen[name] = parse_sighting(info.server, info.parsed_addresses(), texts)
        self.changed()
