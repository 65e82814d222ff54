"""Robots on the network: their announcements, and name conflicts among them."""

from __future__ import annotations

import ipaddress
import re
import threading
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from zeroconf import ServiceInfo, ServiceStateChange, Zeroconf

SERVICE_TYPE = "_ubiquity-robot._tcp.local."
MOST_ADDRESSES = 16
MOST_SOUGHT = 100  # known robots that are requested by name
MOST_STRANGERS = 50  # robots that this computer does not know; a classroom has some dozens
MOST_TWINS = 10  # announcements with known names, beyond the number of known robots
MOST_COUNTED = 10_000
AT_ONCE = 8
RESOLVE_SECONDS = 1.5
_NAME = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9-]{0,61}[A-Za-z0-9])?")
_WORD = re.compile(r"(?:[A-Za-z0-9_][A-Za-z0-9_.-]{0,62})?")
_SHAPES = {
    "base": _WORD,
    "variant": _WORD,
    "user": re.compile(r"(?:[a-z_][a-z0-9_-]{0,31})?"),
    "ros": re.compile(r"[a-z]{0,20}"),
    "version": re.compile(r"(?:[A-Za-z0-9][A-Za-z0-9.+~_-]{0,62})?"),
}
_SCOPE = re.compile(r"[0-9A-Fa-f:.]+(?:%[A-Za-z0-9_.-]{1,15})?")


@dataclass(frozen=True, slots=True)
class Announcement:
    """The announcement of a computer. `host` is the name that its zeroconf daemon gave it, without .local.

    `name` is that of its robot file: the two differ when another computer had the name first. `version` is that of the
    `ur` that set it up; `ros` is its release of ROS 2, '' for ROS 1.
    """

    host: str
    name: str
    addresses: tuple[str, ...]
    base: str = ""
    variant: str = ""
    user: str = ""
    version: str = ""
    ros: str = ""

    @property
    def address(self) -> str:
        """The first IPv4 address, which ROS uses; '' if there is none."""
        return next((address for address in self.addresses if ":" not in address), "")


def parse_sighting(host: str, addresses: Sequence[str], texts: Mapping[str, str]) -> Announcement | None:
    """Parse an announcement from its host name, addresses and text records; None if one is invalid.

    Any computer in the network may announce anything, and announced values become part of command lines, files and
    messages.
    """
    host = host.rstrip(".").removesuffix(".local")
    base = re.sub(r"-\d+$", "", host)  # the suffix that avahi adds to a name in use
    known = {key: texts.get(key, "") for key in ("base", "variant", "user", "ros", "version")}
    name = texts.get("name") or base
    good = (
        all(map(_NAME.fullmatch, (host, name)))
        and all(_SHAPES[key].fullmatch(value) for key, value in known.items())
        and len(addresses) <= MOST_ADDRESSES
        and all(map(_is_address, addresses))
    )
    return Announcement(host, name, tuple(addresses), **known) if good else None


def _is_address(text: str) -> bool:
    try:
        return not ipaddress.ip_address(text.partition("%")[0]).is_multicast and _SCOPE.fullmatch(text) is not None
    except ValueError:
        return False


def read_texts(properties: Mapping[bytes, bytes | None]) -> dict[str, str]:
    """Decode the text records of an announcement. Invalid UTF-8 is replaced by characters that no field may contain."""
    return {key.decode(errors="replace"): (value or b"").decode(errors="replace") for key, value in properties.items()}


class Browser:
    """Browser for robots while its context lasts. `changed` is called from another thread.

    The number of stored robots that are not `known` is limited, so that a flood of announcements cannot hide the
    others. The known ones are also requested by name, so that they do not wait until a flood of announcements has been
    read.
    """

    def __init__(
        self,
        changed: Callable[[], None] = lambda: None,
        known: Collection[str] = (),
        *,
        interfaces: Sequence[str] = (),
        browses: bool = True,
    ) -> None:
        """Browse on the given `interfaces`, by default all; without `browses`, request only the known robots."""
        self._interfaces, self._browses = interfaces, browses
        self._changed = changed
        self._crowd = Crowd(known)
        self._sought = sorted(filter(_NAME.fullmatch, known))[:MOST_SOUGHT]
        self._lookups: list[Future[bool]] = []
        self._zeroconf: Zeroconf  # while the context lasts
        self._pool: ThreadPoolExecutor | None = None

    def __enter__(self) -> Browser:
        from zeroconf import ServiceBrowser, Zeroconf

        self._pool = ThreadPoolExecutor(AT_ONCE)
        self._zeroconf = Zeroconf(interfaces=list(self._interfaces)) if self._interfaces else Zeroconf()
        if self._browses:
            ServiceBrowser(self._zeroconf, SERVICE_TYPE, handlers=[self._notice])
        for name in self._sought:
            self._look_up(f"{name}.{SERVICE_TYPE}")
        return self

    def __exit__(self, *_: object) -> None:
        for lookup in self._lookups:
            lookup.cancel()
        self._zeroconf.close()
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    @property
    def sightings(self) -> list[Announcement]:
        """Return the robots that are visible now."""
        return self._crowd.sightings

    @property
    def left_out(self) -> tuple[int, int]:
        """Return the number of invalid announcements, and the number of those above the limit."""
        return self._crowd.misshapen, self._crowd.too_many

    def find_twin(self, name: str, seconds: float) -> str:
        """Return the address of a computer that zeroconf named NAME-2 after a name conflict; '' without an answer."""
        from zeroconf import AddressResolverIPv4  # type: ignore[attr-defined]  # not in its __all__

        resolver = AddressResolverIPv4(f"{name}-2.local.")
        if not resolver.request(self._zeroconf, seconds * 1000):
            return ""
        return next(iter(resolver.parsed_addresses()), "")

    def _notice(self, zeroconf: Zeroconf, service_type: str, name: str, state_change: ServiceStateChange) -> None:
        from zeroconf import ServiceInfo, ServiceStateChange

        if state_change is ServiceStateChange.Removed:
            self._crowd.remove(name)
            self._changed()
            return
        try:
            info = ServiceInfo(service_type, name)
            is_complete = info.load_from_cache(zeroconf)
        except Exception:
            self._crowd.add(name, None)
            self._changed()
            return
        if is_complete:  # the whole announcement was in one packet, as avahi sends it
            self._on_service(name, info)
        elif self._pool is not None and self._crowd.may_ask(name):
            with suppress(RuntimeError):  # it is being closed
                self._pool.submit(self._resolve, zeroconf, name, info)

    def _resolve(self, zeroconf: Zeroconf, name: str, info: ServiceInfo) -> None:
        # A host that announces itself but does not answer occupies one of a few threads for this long.
        if info.request(zeroconf, RESOLVE_SECONDS * 1000):
            self._on_service(name, info)

    def _look_up(self, name: str) -> None:
        # In the thread of zeroconf, so that robots that are away do not occupy one thread each.
        import asyncio

        from zeroconf import ServiceInfo

        info = ServiceInfo(SERVICE_TYPE, name)
        answer = info.async_request(self._zeroconf, RESOLVE_SECONDS * 1000)
        loop = self._zeroconf.loop
        assert loop is not None, "it runs"
        lookup = asyncio.run_coroutine_threadsafe(answer, loop)

        def finish(done: Future[bool]) -> None:
            if not done.cancelled() and done.exception() is None and done.result():
                self._on_service(name, info)

        lookup.add_done_callback(finish)
        self._lookups.append(lookup)

    def _on_service(self, name: str, info: ServiceInfo) -> None:
        found: Announcement | None = None
        with suppress(Exception):  # any error of the library from untrusted packets
            found = parse_sighting(info.server or "", info.parsed_addresses(), read_texts(info.properties))
        self._crowd.add(name, found)
        self._changed()


class Crowd:
    """Announcements by service name, of limited number: all of the `known` robots, and some others."""

    def __init__(self, known: Collection[str] = ()) -> None:
        self._known = frozenset(known)
        self._seen: dict[str, Announcement | None] = {}
        self._asked: set[str] = set()
        self._late: set[str] = set()
        self._lock = threading.Lock()

    @property
    def sightings(self) -> list[Announcement]:
        """Return the stored announcements."""
        with self._lock:
            return [one for one in self._seen.values() if one is not None]

    @property
    def misshapen(self) -> int:
        """Return the number of invalid announcements."""
        with self._lock:
            return sum(one is None for one in self._seen.values())

    @property
    def too_many(self) -> int:
        """Return the number of announcements that were dropped, counted up to a limit."""
        return len(self._late)

    def may_ask(self, name: str) -> bool:
        """Return whether a service may be asked for its details."""
        with self._lock:
            label = name.partition(".")[0]
            if label in self._known or name in self._asked or len(self._asked) < MOST_STRANGERS:
                self._asked.add(name)
                return True
            self._note_late(name)
            return False

    def add(self, name: str, sighting: Announcement | None) -> None:
        """Store the announcement of a service, or None for an invalid one, unless the limit of its kind is reached."""
        with self._lock:
            is_known = sighting is not None and sighting.name in self._known
            same = [
                key
                for key, one in self._seen.items()
                if key != name and (one is not None and one.name in self._known) == is_known
            ]
            if len(same) < (MOST_STRANGERS if not is_known else len(self._known) + MOST_TWINS):
                self._seen[name] = sighting
            else:
                self._seen.pop(name, None)
                self._note_late(name)

    def remove(self, name: str) -> None:
        """Remove a service that was withdrawn."""
        with self._lock:
            self._seen.pop(name, None)
            self._asked.discard(name)
            self._late.discard(name)

    def _note_late(self, name: str) -> None:
        if len(self._late) < MOST_COUNTED:
            self._late.add(name)
