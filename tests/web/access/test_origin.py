import pytest

from ur.web.access.origin import allows_host, allows_origin, allows_viewer, make_origins, read_origin
from ur.web.access.rate import draw, make_bucket
from ur.web.server.logins.gate import name_device

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


@pytest.mark.parametrize(
    ("origin", "allowed"),
    [
        (None, True),  # a program
        ("https://app.foxglove.dev", True),
        ("file://", True),
        ("http://localhost:8080", True),
        ("http://robot.local:8090", True),
        ("https://viewer.example", True),
        ("http://evil.example", False),
        ("http://app.foxglove.dev", False),
        ("https://app.foxglove.dev.evil.example", False),
        ("http://localhost.evil.example", False),
        ("https://localhost:8080@evil.example", False),
        ("null", False),
        ("", False),
    ],
)
def test_known_viewers_and_those_of_this_computer_are_origins(origin: str | None, allowed: bool) -> None:
    assert allows_viewer("robot.local:8090", origin, {"https://viewer.example"}) is allowed


@pytest.mark.parametrize(
    ("text", "origin"),
    [
        ("https://Viewer.example/", "https://viewer.example"),
        ("http://10.0.0.2:8080", "http://10.0.0.2:8080"),
        ("viewer.example", None),
        ("https://viewer.example/page", None),
        ("file://", None),
        ("https://", None),
        ("", None),
    ],
)
def test_origin_that_a_person_wrote_is_read_as_browsers_send_it(text: str, origin: str | None) -> None:
    assert read_origin(text) == origin
