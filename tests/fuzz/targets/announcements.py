"""Announcements of robots: packets of multicast DNS, and announcements with any fields."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from tests.fuzz.target import Target
from zeroconf import DNSCache, ServiceInfo, ServiceStateChange  # type: ignore[attr-defined]  # not in its __all__
from zeroconf._protocol.incoming import DNSIncoming

from ur.robot.discovery.announcements import SERVICE_TYPE, Announcement, Browser, parse_sighting, read_texts
from ur.robot.discovery.listing import list_robots

_WORDS = (
    *(b"name", b"base", b"variant", b"user", b"version", b"bob", b"magni", b"-2", b".local.", b"txtvers=1"),
    *(
        b"\xc0\x0c",
        b"\x00\x10\x80\x01",
        b"\x00\x21\x80\x01",
        b"\x00\x01\x00\x01",
        b"\x00\x1c\x80\x01",
        b"\x00\x0c\x00\x01",
    ),
    *(b"fe80::1%eth0", b"224.0.0.1", b"127.0.0.1", b"\\u001b[2J", b"\\udcff"),
)


def _read_packet(data: bytes, _: Path) -> None:
    """A packet as it arrives, through the library, to what is listed."""
    packet = DNSIncoming(data)
    records = packet.answers() if packet.valid else []
    cache = DNSCache()
    for record in records:
        cache.async_add_records([record])
    browser = Browser(known=("bob",))
    stack: Any = SimpleNamespace(cache=cache)
    for name in {getattr(record, "alias", "") for record in records} | {record.name for record in records}:
        if name.endswith(SERVICE_TYPE):
            browser._notice(stack, SERVICE_TYPE, name, ServiceStateChange.Added)
    _check_list(browser.sightings)


def _read_fields(data: bytes, _: Path) -> None:
    """An announcement whose fields hold whatever fits into them; the input is JSON."""
    try:
        fields: Any = json.loads(data)
        host, addresses = str(fields["host"]), [str(each) for each in fields["addresses"]]
        texts = {str(key).encode("utf-8", "surrogatepass"): _encode(value) for key, value in fields["texts"].items()}
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return  # not an input: zeroconf gives names, addresses and pairs of bytes
    found = parse_sighting(host, addresses, read_texts(texts))
    _check_list([found] if found else [])


def _encode(value: object) -> bytes | None:
    return None if value is None else str(value).encode("utf-8", "surrogatepass")


def _check_list(sightings: list[Announcement]) -> None:
    for row in list_robots(sightings, ()):
        texts = (row.name, row.address, row.base, row.variant, row.version, row.problem, row.help, row.runs, row.clock)
        assert all(text.isprintable() for text in texts), "control characters reach the list"
    for one in sightings:
        assert not any(text.startswith("-") for text in (one.host, one.name, one.user, *one.addresses)), "an option"


def _make_packets() -> list[bytes]:
    from zeroconf import DNSOutgoing  # type: ignore[attr-defined]  # likewise

    packets = []
    for texts in (
        {"name": "bob", "base": "magni", "variant": "lidar", "user": "ros", "version": "0.1.0"},
        {"name": ""},
    ):
        info = ServiceInfo(
            SERVICE_TYPE,
            f"bob.{SERVICE_TYPE}",
            port=22,
            addresses=[b"\x0a\x00\x00\x02"],
            server="bob.local.",
            properties=texts,
        )
        out = DNSOutgoing(0x8400)
        for record in (info.dns_pointer(), info.dns_service(), info.dns_text(), *info.dns_addresses()):
            out.add_answer_at_time(record, 0)
        packets += out.packets()
    return packets


TARGETS = (
    Target("announcement", _read_packet, _WORDS, _make_packets),
    Target("announcement_fields", _read_fields, _WORDS),
)
