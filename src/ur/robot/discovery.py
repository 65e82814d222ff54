"""Robots on the network: who announces itself, who is known and away, and which names are taken twice."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from ur.robot.record import Record

SERVICE_TYPE = "_ubiquity-robot._tcp.local."


@dataclass(frozen=True, slots=True)
class Sighting:
    """A computer that announces itself. `host` is the name that its zeroconf daemon gave it, without .local.

    `name` is what its robot file says: the two differ when another computer had the name first.
    """

    host: str
    name: str
    addresses: tuple[str, ...]
    base: str = ""
    variant: str = ""
    user: str = ""


@dataclass(frozen=True, slots=True)
class Row:
    """A robot as it is listed. `addresses` is empty when it is away; `problem` is empty when there is none."""

    name: str
    addresses: tuple[str, ...]
    base: str
    variant: str
    problem: str = ""
    help: str = ""


def list_robots(sightings: Iterable[Sighting], records: Sequence[Record]) -> list[Row]:
    """Everybody who is there, then those known from earlier who are not; each group by name."""
    seen = sorted(sightings, key=lambda one: (one.name, one.host))
    names = [one.name for one in seen]
    rows = [_row(one, names.count(one.name) > 1) for one in seen]
    away = [record for record in records if record.name not in names]
    return rows + [Row(record.name, (), record.base, record.variant) for record in away]


def _row(one: Sighting, twice: bool) -> Row:
    problem = help = ""
    if twice or one.host != one.name:
        problem = f"two computers are called {one.name}: this one answers to {one.host}.local"
        help = f"ur robot setup {one.host}.local --name ANOTHER"
    return Row(one.name, one.addresses, one.base, one.variant, problem, help)


def parse_sighting(host: str, addresses: Sequence[str], texts: dict[str, str]) -> Sighting:
    """A sighting from an announcement's host name, addresses and text records."""
    host = host.rstrip(".").removesuffix(".local")
    base = re.sub(r"-\d+$", "", host)  # what avahi adds when a name is taken
    name = texts.get("name") or base
    return Sighting(
        host, name, tuple(addresses), texts.get("base", ""), texts.get("variant", ""), texts.get("user", "")
    )


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
