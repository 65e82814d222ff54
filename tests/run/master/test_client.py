import socket
import threading
import xmlrpc.client
from typing import Any

import pytest

from ur.run.master.client import format_master_uri, parse_master_uri, unify_clear
from ur.run.master.xml_rpc import CallRefused
from ur.source import UserError


@pytest.mark.parametrize(
    "uri",
    [
        *("", "localhost:11311", "http://localhost", "http://:1", "http://h:0", "ftp://h:11311", "http://::1:11311"),
        *("http://::1", "http://[::1]", "http://[]:1", "http://[::1:11311", "http://h:²", "http://h:1:2"),
    ],
)
def test_bad_master_uri_is_explained(uri: str) -> None:
    with pytest.raises(UserError, match="expected http://HOST:PORT"):
        parse_master_uri(uri)


def test_ipv6_address_of_a_master_stands_in_brackets() -> None:
    master = parse_master_uri("http://[::1]:11311")
    assert (master.host, master.port) == ("::1", 11311)
    assert format_master_uri("::1", 11400) == "http://[::1]:11400"
    assert format_master_uri("bob.local", 11400) == "http://bob.local:11400"


def test_master_on_ipv6_is_asked_with_its_address_in_brackets() -> None:
    heads: list[bytes] = []

    def serve() -> None:
        link, _ = listener.accept()
        with link:
            heads.append(link.recv(65536))
            link.sendall(b"HTTP/1.0 200 OK\r\n\r\n" + answer)

    answer = xmlrpc.client.dumps(([1, "", "the id"],), methodresponse=True).encode()
    with socket.create_server(("::1", 0), family=socket.AF_INET6) as listener:
        port = listener.getsockname()[1]
        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        assert parse_master_uri(f"http://[::1]:{port}").get_run_id() == "the id"
        thread.join(60)
    assert f"Host: [::1]:{port}\r\n".encode() in heads[0]


def test_master_uri_may_end_with_a_slash() -> None:
    master = parse_master_uri("http://robot.local:11311/")
    assert (master.host, master.port) == ("robot.local", 11311)


def test_cleared_namespaces_inside_others_are_dropped() -> None:
    assert unify_clear(["/a/b", "/a", "/ab", "/a/"]) == ["/a/", "/ab/"]


@pytest.mark.ros
def test_parameters_arrive_with_types_and_cleared_ones_go(master: int) -> None:
    client = parse_master_uri(f"http://localhost:{master}")
    values = {
        "/a/one": 1,
        "/a/half": 0.5,
        "/a/text": "<&>",
        "/a/yes": True,
        "/a/list": [1, "b"],
        "/a/data": b"\x00\xff",
    }
    client.set_parameters(values)
    stored: Any = xmlrpc.client.ServerProxy(f"http://localhost:{master}").getParam("/test", "/a")
    got = stored[2]
    assert got.pop("data").data == b"\x00\xff"
    assert got == {"one": 1, "half": 0.5, "text": "<&>", "yes": True, "list": [1, "b"]}
    assert type(got["yes"]) is bool
    client.set_parameters({"/a/new": 2}, clear=["/a/", "/not/there"])
    assert client.call("getParam", "/a") == {"new": 2}


@pytest.mark.ros
def test_only_nodes_that_do_not_answer_are_removed(master: int) -> None:
    client = parse_master_uri(f"http://localhost:{master}")
    other: Any = xmlrpc.client.ServerProxy(f"http://localhost:{master}")
    other.registerPublisher("/dead", "/chat", "std_msgs/String", "http://localhost:9/")
    other.registerSubscriber("/dead", "/news", "std_msgs/String", "http://localhost:9/")
    other.registerService("/dead", "/help", "rosrpc://localhost:9", "http://localhost:9/")
    other.registerPublisher("/alive", "/chat", "std_msgs/String", client.uri)
    client.remove_dead_nodes(["/dead", "/alive", "/nobody"])
    publishers, subscribers, services = client.call("getSystemState")
    assert ["/chat", ["/alive"]] in publishers
    assert "/dead" not in str([publishers, subscribers, services])
    with pytest.raises(CallRefused):
        client.call("lookupNode", "/dead")
