"""Announcements of robots, as they are heard."""

from __future__ import annotations

from ur.robot.discovery import Sighting, parse_sighting


def test_announcement_says_what_the_robot_is() -> None:
    texts = {"name": "bob", "base": "magni", "variant": "lidar", "user": "pi", "version": "0.1.0", "new": "x"}
    sighting = parse_sighting("bob-2.local.", ["fe80::1", "10.0.0.3"], texts)
    assert sighting == Sighting("bob-2", "bob", ("fe80::1", "10.0.0.3"), "magni", "lidar", "pi", "0.1.0")
    assert sighting.address == "10.0.0.3"


def test_announcement_without_a_name_is_known_by_its_host_name() -> None:
    assert parse_sighting("bob-2.local.", ["10.0.0.3"], {}) == Sighting("bob-2", "bob", ("10.0.0.3",))
    assert parse_sighting("r2-d2.local.", [], {"name": "r2-d2"}).name == "r2-d2"
