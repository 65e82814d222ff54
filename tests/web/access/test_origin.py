from __future__ import annotations

import pytest

from ur.web.access.browsers import name_device
from ur.web.access.origin import allows_host, allows_origin, make_origins
from ur.web.access.rate import draw, make_bucket

ORIGINS = make_origins(["bob.local", "192.168.1.7", "fe80::1"], 8090)


@pytest.mark.parametrize(
    ("host", "allowed"),
    [
        ("localhost:8090", True),
        ("localhost:9000", True),  # ssh -L 9000:localhost:8090
        ("127.0.0.1:8090", True),
        ("[::1]:8090", True),
        ("bob.local:8090", True),
        ("BOB.local.:8090", True),
        ("192.168.1.7:8090", True),
        ("[fe80::1]:8090", True),
        ("bob.local:80", False),
        ("bob.local", False),
        ("evil.example:8090", False),
        ("localhost.evil.example:8090", False),
        ("localhost:8090@evil.example", False),
        ("", False),
        (None, False),
        ("localhost:" + "9" * 5000, False),
    ],
)
def test_only_names_of_this_server_are_hosts(host: str | None, allowed: bool) -> None:
    assert allows_host(ORIGINS, host) is allowed


@pytest.mark.parametrize(
    ("host", "origin", "allowed"),
    [
        ("localhost:8090", "http://localhost:8090", True),
        ("localhost:8090", "http://localhost:8091", False),
        ("localhost:8090", "http://127.0.0.1:8090", False),
        ("localhost:8090", "null", False),
        ("localhost:8090", None, False),
        ("evil.example", "http://evil.example", False),
    ],
)
def test_only_the_page_itself_is_an_origin(host: str, origin: str | None, allowed: bool) -> None:
    assert (allows_host(ORIGINS, host) and allows_origin(host, origin)) is allowed


def test_address_that_the_request_was_sent_to_is_a_host() -> None:
    assert allows_host(ORIGINS, "10.0.0.7:8090", "10.0.0.7")
    assert allows_host(ORIGINS, "[fd00::7]:8090", "fd00::7")
    assert not allows_host(ORIGINS, "10.0.0.7:80", "10.0.0.7")
    assert not allows_host(ORIGINS, "10.0.0.8:8090", "10.0.0.7")


def test_bucket_allows_a_burst_and_then_its_rate() -> None:
    bucket, allowed = make_bucket(2.0, 3.0, 0.0), []
    for now in (0.0, 0.0, 0.0, 0.0, 0.4, 0.5, 0.6):
        bucket, ok = draw(bucket, now)
        allowed.append(ok)
    assert allowed == [True, True, True, False, False, True, False]


def test_devices_have_names_that_people_know() -> None:
    assert name_device("Mozilla/5.0 (Linux; Android 14; Pixel 8)") == "Android"
    assert name_device("Mozilla/5.0 (X11; Linux x86_64)") == "Linux"
    assert name_device(None) == "a browser"
