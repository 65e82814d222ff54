"""Announcements of robots, as they are heard."""

import threading
import uuid
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.robot.discovery.announcements import (
    MOST_STRANGERS,
    SERVICE_TYPE,
    Announcement,
    Browser,
    Crowd,
    parse_sighting,
    read_texts,
)


def test_announcement_says_what_the_robot_is() -> None:
    texts = {"name": "bob", "base": "magni", "variant": "lidar", "user": "pi", "version": "0.1.0", "new": "x"}
    sighting = parse_sighting("bob-2.local.", ["fe80::1", "10.0.0.3"], texts)
    assert sighting == Announcement("bob-2", "bob", ("fe80::1", "10.0.0.3"), "magni", "lidar", "pi", "0.1.0")
    assert sighting is not None
    assert sighting.address == "10.0.0.3"


def test_announcement_without_a_name_is_known_by_its_host_name() -> None:
    assert parse_sighting("bob-2.local.", ["10.0.0.3"], {}) == Announcement("bob-2", "bob", ("10.0.0.3",))
    assert parse_sighting("r2-d2.local.", [], {"name": "r2-d2"}) == Announcement("r2-d2", "r2-d2", ())


HOSTILE = [
    "-oProxyCommand=touch /tmp/x",
    "a b",
    "a\nb",
    "a\x1b[2J",
    "a\x1b]52;c;eA==\x07",
    "a;b",
    "$(b)",
    "`b`",
    "a/../b",
    "a@b",
    "a\u202eb",
    "\ufffd",
    "x" * 64,
    "[red]a",
]


@pytest.mark.parametrize("value", HOSTILE)
@pytest.mark.parametrize("field", ["host", "name", "base", "variant", "user", "version"])
def test_announcement_of_another_shape_is_dropped(field: str, value: str) -> None:
    texts = {"name": "bob", "base": "magni", "variant": "lidar", "user": "ros", "version": "0.1.0"}
    host = value if field == "host" else "bob"
    assert parse_sighting(f"{host}.local.", ["10.0.0.3"], texts if field == "host" else {**texts, field: value}) is None


@pytest.mark.parametrize(
    "addresses", [["-oX=1"], ["10.0.0.3; x"], ["fe80::1%$(x)"], ["224.0.0.251"], ["10.0.0.3"] * 17, [""], ["1.2.3.4 "]]
)
def test_address_that_is_none_is_dropped(addresses: list[str]) -> None:
    assert parse_sighting("bob.local.", addresses, {}) is None


def test_addresses_of_a_link_have_its_name() -> None:
    assert parse_sighting("bob.local.", ["fe80::1%wlan0", "10.0.0.3"], {}) is not None


@given(st.text(), st.lists(st.text()), st.dictionaries(st.sampled_from(["name", "base", "user", "version"]), st.text()))
def test_whatever_is_announced_is_harmless_or_dropped(host: str, addresses: list[str], texts: dict[str, str]) -> None:
    found = parse_sighting(host, addresses, texts)
    if found is not None:
        for each in (found.host, found.name, found.base, found.user, found.version, *found.addresses):
            assert each.isascii()
            assert each.isprintable()
            assert not each.startswith("-")
            assert not set(each) & set(" ;|&$`'\"\\<>(){}[]*?!/@=")


def test_bytes_that_are_no_text_drop_the_announcement_alone() -> None:
    texts = read_texts({b"name": b"bob\xff", b"\xff": None, b"base": b"magni"})
    assert parse_sighting("bob.local.", [], texts) is None
    assert parse_sighting("bob.local.", [], read_texts({b"name": b"bob", b"\xff\xfe": b"\xff"})) is not None


def stranger(number: int) -> Announcement:
    return Announcement(f"fake{number}", f"fake{number}", ("10.0.0.9",))


def test_crowd_of_strangers_hides_no_known_robot() -> None:
    crowd = Crowd({"bob"})
    for number in range(300):
        crowd.add(f"fake{number}._x", stranger(number))
    bob = Announcement("bob", "bob", ("10.0.0.2",))
    crowd.add("bob._x", bob)
    assert bob in crowd.sightings
    assert len(crowd.sightings) == MOST_STRANGERS + 1
    assert (crowd.misshapen, crowd.too_many) == (0, 300 - MOST_STRANGERS)
    assert crowd.may_ask("bob._x")
    crowd.add("bad._x", None)
    crowd.remove("fake0._x")
    assert len(crowd.sightings) == MOST_STRANGERS


def test_crowd_under_a_known_name_is_bounded_too() -> None:
    crowd = Crowd({"bob"})
    for number in range(300):
        crowd.add(f"fake{number}._x", Announcement(f"fake{number}", "bob", ("10.0.0.9",)))
    assert len(crowd.sightings) < 20


def test_only_some_strangers_are_asked_what_they_are() -> None:
    crowd = Crowd({"bob"})
    assert [crowd.may_ask(f"fake{number}._x") for number in range(100)].count(True) == MOST_STRANGERS
    assert crowd.may_ask("bob._x")
    assert crowd.too_many == 100 - MOST_STRANGERS


def test_broken_record_hides_nothing() -> None:
    zeroconf = pytest.importorskip("zeroconf")
    cache = zeroconf.DNSCache()
    kind = "_ubiquity-robot._tcp.local."

    def announce(label: str, text: bytes) -> str:
        name = f"{label}.{kind}"
        cache.async_add_records(
            [
                zeroconf.DNSService(name, 33, 1, 120, 0, 0, 22, f"{label}.local."),
                zeroconf.DNSText(name, 16, 1, 120, text),
                zeroconf.DNSAddress(f"{label}.local.", 1, 1, 120, bytes([10, 0, 0, 2])),
            ]
        )
        return name

    class NetworkOfAnnouncements:
        def __init__(self) -> None:
            self.cache = cache

    network: Any = NetworkOfAnnouncements()

    names = [
        announce("evil", b"\x09\xff\xfe=\xff\xff\xff\xff\xff\x40short"),
        announce("worse", b"\x0cname=bob\xff\xfe\xfd\xfc"),
        announce("bob", b"\x08name=bob\x0abase=magni"),
    ]
    names.insert(2, f"\x1b]52;c;eA==\x07\nready.{kind}")  # the library raises an error at such a name
    changes: list[Any] = []
    browser = Browser(lambda: changes.append(1))
    for name in names:
        browser._notice(network, kind, name, zeroconf.ServiceStateChange.Added)
    assert [one.name for one in browser.sightings if one.base] == ["bob"]
    assert browser.left_out[0] >= 1
    browser._notice(network, kind, names[3], zeroconf.ServiceStateChange.Removed)
    assert "bob" not in [one.name for one in browser.sightings]


def test_known_robot_is_found_by_its_name_where_browsing_finds_nothing() -> None:
    zeroconf = pytest.importorskip("zeroconf")
    label = f"known-{uuid.uuid4().hex[:12]}"  # others on this network test as well
    announced = zeroconf.ServiceInfo(
        SERVICE_TYPE,
        f"{label}.{SERVICE_TYPE}",
        addresses=[bytes([10, 0, 0, 2])],
        port=22,
        server=f"{label}.local.",
        properties={"name": label, "base": "magni"},
    )
    responder = zeroconf.Zeroconf(interfaces=["127.0.0.1"])
    found = threading.Event()
    try:
        responder.register_service(announced)
        known = {label, "away-for-ever", "no name"}
        with Browser(found.set, known, interfaces=["127.0.0.1"], browses=False) as browser:
            assert found.wait(60.0)
            assert browser.sightings == [Announcement(label, label, ("10.0.0.2",), "magni")]
    finally:
        responder.close()
