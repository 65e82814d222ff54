"""The proxy of a set-up: who may use it, for which servers, and that answers arrive whole."""

import base64
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from ur.robot.setup.internet.share import (
    Forward,
    Refusal,
    Server,
    find_addresses,
    is_forbidden,
    parse_server,
    read_request,
    run_proxy,
)
from ur.robot.ssh.secret import Secret

PASSWORD = Secret("word")
SERVER = Server("packages.test", 80)
LOGIN = "Proxy-Authorization: Basic " + base64.b64encode(b"ubiquity:word").decode()
BODY = b"x" * 3_000_000


def request(line: str, *fields: str) -> bytes:
    return "\r\n".join([line, *fields, "", ""]).encode()


@pytest.mark.parametrize(
    ("url", "server"),
    [
        ("http://Packages.test/debian", SERVER),
        ("https://packages.test", Server("packages.test", 443)),
        ("http://user:word@packages.test:8080/x", Server("packages.test", 8080)),
        ("file:/srv/offered", None),
        ("http://[::1]/", None),
        ("http://a b/", None),
        ("http://x:99999999/", None),
        ("", None),
    ],
)
def test_server_of_a_url_is_a_plain_host_and_a_port(url: str, server: Server | None) -> None:
    assert parse_server(url) == server


def test_get_is_forwarded_without_the_fields_for_the_proxy() -> None:
    head = request("GET http://packages.test/a?b HTTP/1.1", "Host: packages.test", LOGIN, "Range: bytes=1-")
    forward = read_request(head, {SERVER}, PASSWORD)
    assert isinstance(forward, Forward)
    assert forward.head == b"GET /a?b HTTP/1.1\r\nHost: packages.test\r\nRange: bytes=1-\r\nConnection: close\r\n\r\n"


def test_connect_is_a_tunnel_to_a_listed_server() -> None:
    head = request("CONNECT packages.test:443 HTTP/1.1", LOGIN)
    assert read_request(head, {Server("packages.test", 443)}, PASSWORD) == Forward(Server("packages.test", 443), b"")


@pytest.mark.parametrize(
    ("line", "login", "status"),
    [
        ("GET http://packages.test/ HTTP/1.1", "", "407"),
        ("GET http://packages.test/ HTTP/1.1", LOGIN[:-4], "407"),
        ("GET http://other.test/ HTTP/1.1", LOGIN, "403"),
        ("CONNECT packages.test:22 HTTP/1.1", LOGIN, "403"),
        ("POST http://packages.test/ HTTP/1.1", LOGIN, "405"),
        ("GET /etc/passwd HTTP/1.1", LOGIN, "405"),
        ("nonsense", LOGIN, "400"),
    ],
)
def test_everything_else_is_refused(line: str, login: str, status: str) -> None:
    refusal = read_request(request(line, login), {SERVER}, PASSWORD)
    assert isinstance(refusal, Refusal)
    assert refusal.status.startswith(status)


@pytest.mark.parametrize(
    ("address", "forbidden"),
    [
        *(("127.0.0.1", True), ("::1", True), ("::ffff:127.0.0.1", True), ("169.254.1.1", True), ("fe80::1%x", True)),
        *(("0.0.0.0", True), ("192.168.1.5", False), ("10.1.2.3", False), ("2001:db8::1", False)),
    ],
)
def test_this_computer_itself_is_never_reached(address: str, forbidden: bool) -> None:
    assert is_forbidden(address) is forbidden


def test_server_that_is_this_computer_or_has_no_address_is_not_reached() -> None:
    assert find_addresses(Server("localhost", 80)) == []
    assert find_addresses(Server("nobody.invalid", 80)) == []


@contextmanager
def web_server() -> Iterator[int]:
    """A server that answers each connection's first request with BODY, whatever it is."""
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def serve() -> None:
            while True:
                try:
                    client, _ = listening.accept()
                except OSError:
                    return
                with client:
                    client.recv(65536)
                    client.sendall(b"HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n" + BODY)

        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield int(listening.getsockname()[1])
        finally:
            listening.shutdown(socket.SHUT_RDWR)
            thread.join()


def ask(port: int, head: bytes) -> bytes:
    with socket.create_connection(("127.0.0.1", port), timeout=60) as client:
        client.sendall(head)
        said = b""
        while piece := client.recv(65536):
            said += piece
    return said


def find_loopback(_: Server) -> list[str]:
    return ["127.0.0.1"]


def test_answers_arrive_whole_though_more_requests_are_under_way() -> None:
    with web_server() as there, run_proxy({Server("packages.test", there)}, PASSWORD, find_loopback) as port:
        line = f"GET http://packages.test:{there}/a HTTP/1.1"
        said = ask(port, request(line, LOGIN) * 5)
        assert said.endswith(BODY)
        tunnel = ask(port, request(f"CONNECT packages.test:{there} HTTP/1.1", LOGIN) + b"hello")
        assert tunnel.startswith(b"HTTP/1.1 200 Connection established\r\n\r\nHTTP/1.1 200 OK")
        assert tunnel.endswith(BODY)


def test_refusals_and_servers_that_are_away_are_answered_and_the_port_closes() -> None:
    with socket.create_server(("127.0.0.1", 0)) as closed:
        away = closed.getsockname()[1]
    with run_proxy({Server("packages.test", away)}, PASSWORD, find_loopback) as port:
        line = f"GET http://packages.test:{away}/a HTTP/1.1"
        assert ask(port, request(line, LOGIN)).startswith(b"HTTP/1.1 502 ")
        assert ask(port, request(line)).startswith(b"HTTP/1.1 407 ")
        assert ask(port, request("GET http://other.test/ HTTP/1.1", LOGIN)).startswith(b"HTTP/1.1 403 ")
        with socket.create_connection(("127.0.0.1", port)) as client:  # and one that is open at the end
            client.sendall(b"GET")
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", port))
