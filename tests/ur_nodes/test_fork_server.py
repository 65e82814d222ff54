"""The process that forks nodes, in the process of the tests; see also `tests/run/host/test_forks.py`."""

import gc
import os
import socket
from collections.abc import Iterator
from typing import NoReturn

import pytest

from ur.run.host.protocol import GROUP, receive, send
from ur_nodes import fork_server


@pytest.fixture
def link(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[socket.socket, int]]:
    """The host's end of the link to a server, and the descriptor of the server's end."""
    monkeypatch.setenv("ROS_VERSION", "0")
    ours, theirs = socket.socketpair()
    yield ours, theirs.detach()
    ours.close()
    gc.unfreeze()


def fill(pipe: int) -> NoReturn:
    while True:
        os.write(pipe, b"1" * 65536)


def test_server_whose_host_has_ended_imports_nothing_and_ends(link: tuple[socket.socket, int]) -> None:
    host, descriptor = link
    host.close()
    fork_server.main(["", "no_such_module", str(descriptor)])
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.fstat(descriptor)


def test_node_whose_host_is_not_its_parent_ends_before_it_runs(link: tuple[socket.socket, int]) -> None:
    host, descriptor = link
    null = os.open(os.devnull, os.O_RDWR)
    send(host, ("/node", ["no_such_module", "argument"], "/", {"GIVEN": "1"}, GROUP), (null, null, null))
    host.shutdown(socket.SHUT_WR)
    fork_server.main(["", "json", "no_such_module", str(descriptor)])
    (name, pid), (gate,) = receive(host)
    os.close(null)
    assert (name, pid > 1) == ("/node", True)
    with pytest.raises(BrokenPipeError):  # the other end of the pipe is closed when the node has ended
        fill(gate)
    os.close(gate)


def test_server_takes_requests_until_nobody_takes_its_answers(link: tuple[socket.socket, int]) -> None:
    host, descriptor = link
    null = os.open(os.devnull, os.O_RDWR)
    send(host, ("/node", ["json"], "/", {}, GROUP), (null, null, null))
    host.close()
    os.close(null)
    fork_server.main(["", str(descriptor)])
