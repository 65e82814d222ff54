from __future__ import annotations

import errno
import socket
import struct
import threading

import pytest

from ur_nodes.ros1.repairs.sockets import (
    is_abandoned,
    is_link_trouble,
    is_remote,
    limit_sending,
    limit_waiting,
    unless_abandoned,
    watch_peer,
)


@pytest.mark.parametrize(
    ("problem", "trouble"),
    [
        (TimeoutError("timed out"), True),
        (OSError(errno.EHOSTUNREACH, "no route to host"), True),
        (OSError(errno.ETIMEDOUT, "timed out"), True),
        (ConnectionRefusedError(errno.ECONNREFUSED, "refused"), False),
        (ConnectionResetError(errno.ECONNRESET, "reset"), False),
        (ValueError("no error of the network"), False),
        (None, False),
    ],
)
def test_trouble_of_the_link_is_told_from_a_refusal(problem: BaseException | None, trouble: bool) -> None:
    assert is_link_trouble(problem) is trouble


def test_peer_on_the_same_computer_is_not_remote() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server, socket.create_connection(server.getsockname()) as client:
        assert not is_remote(client)
    with socket.socket() as alone:
        assert not is_remote(alone)


def test_connection_is_abandoned_when_its_peer_ends_before_the_first_byte() -> None:
    ours, peer = socket.socketpair()
    with ours:
        limit_waiting(ours, 0.05)
        assert not is_abandoned(ours)  # silent so far
        peer.sendall(b"header")
        assert not is_abandoned(ours)
        assert ours.recv(6) == b"header"
        peer.close()
        assert is_abandoned(ours)


def test_abandoned_connection_is_closed_and_any_other_accepted() -> None:
    accepted: list[object] = []
    accept = unless_abandoned(lambda *connection: accepted.append(connection))
    ours, peer = socket.socketpair()
    with ours, peer:
        peer.sendall(b"header")
        accept("server", ours, ("peer", 1))
        assert accepted == [("server", ours, ("peer", 1))]
    ours, peer = socket.socketpair()
    peer.close()
    accept("server", ours, ("peer", 1))
    assert len(accepted) == 1
    assert ours.fileno() < 0


def test_connection_that_its_peer_has_reset_is_abandoned() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        client = socket.create_connection(server.getsockname())
        ours, _ = server.accept()
        client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        client.close()
        with ours:
            assert is_abandoned(ours)


def test_limits_are_set_on_the_socket() -> None:
    with socket.socket() as sock:
        watch_peer(sock)
        limit_sending(sock, 1.5)
        assert sock.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
        assert sock.getsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE) == 1
        assert sock.getsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT) == 1500


def test_limited_read_ends_and_an_unlimited_one_waits_for_data() -> None:
    one, other = socket.socketpair()
    with one, other:
        limit_waiting(one, 0.01)
        with pytest.raises(BlockingIOError):
            one.recv(1)
        limit_waiting(one, 0.0)
        sender = threading.Timer(0.05, other.send, [b"x"])
        sender.start()
        assert one.recv(1) == b"x"
        sender.join()
