from __future__ import annotations

import errno
import socket
import threading
import time
import xmlrpc.client
from collections.abc import Iterator
from typing import Any
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from ur.robot.addresses import AddressCache
from ur_nodes.ros1.repairs.xml_rpc_links import BoundedConnection, BoundedTransport


@pytest.fixture
def server() -> Iterator[SimpleXMLRPCServer]:
    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as made:
        made.register_function(lambda: 7, "getPid")
        thread = threading.Thread(target=made.serve_forever, args=(0.01,))
        thread.start()
        yield made
        made.shutdown()
        thread.join()


def make_proxy(port: int, kind: type[BoundedTransport] = BoundedTransport, **limits: Any) -> xmlrpc.client.ServerProxy:
    transport = kind(AddressCache(), lambda: False, **limits)
    return xmlrpc.client.ServerProxy(f"http://127.0.0.1:{port}", transport=transport)


def test_call_is_answered(server: SimpleXMLRPCServer) -> None:
    with make_proxy(server.server_address[1]) as proxy:
        assert proxy.getPid() == 7
        assert proxy.getPid() == 7  # over the same connection, or over another


def test_call_that_nobody_answers_ends() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        proxy = make_proxy(silent.getsockname()[1], answer_limit=0.05)
        with proxy, pytest.raises(TimeoutError):
            proxy.getPid()


def test_node_that_ends_does_not_wait_long_for_a_busy_master() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        transport = BoundedTransport(AddressCache(), lambda: True)
        address = f"http://127.0.0.1:{silent.getsockname()[1]}"
        began = time.monotonic()
        with xmlrpc.client.ServerProxy(address, transport=transport) as proxy, pytest.raises(TimeoutError) as problem:
            proxy.unregisterPublisher("/node", "/topic", "uri")
    assert time.monotonic() - began < 10.0
    assert problem.value.errno == errno.ETIMEDOUT  # rospy unpacks number and text


def test_refused_call_is_not_tried_again() -> None:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    with make_proxy(port) as proxy, pytest.raises(ConnectionRefusedError):
        proxy.getPid()


def test_call_that_the_network_loses_is_tried_again(server: SimpleXMLRPCServer) -> None:
    tries: list[str] = []

    class LosesTheFirst(BoundedConnection):
        def connect(self) -> None:
            tries.append(self.host)
            if len(tries) == 1:
                raise OSError(errno.EHOSTUNREACH, "no route to host")
            super().connect()

    class Transport(BoundedTransport):
        connection_class = LosesTheFirst

    with make_proxy(server.server_address[1], Transport) as proxy:
        assert proxy.getPid() == 7
    assert len(tries) == 2


def test_ending_node_does_not_try_again(server: SimpleXMLRPCServer) -> None:
    class Loses(BoundedConnection):
        def connect(self) -> None:
            raise OSError(errno.EHOSTUNREACH, "no route to host")

    class LosingTransport(BoundedTransport):
        connection_class = Loses

    transport = LosingTransport(AddressCache(), lambda: True)
    proxy = xmlrpc.client.ServerProxy(f"http://127.0.0.1:{server.server_address[1]}", transport=transport)
    with proxy, pytest.raises(OSError, match="no route"):
        proxy.getPid()
