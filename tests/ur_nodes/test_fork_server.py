"""The process that forks nodes, in the process of the tests; see also `tests/run/host/test_forks.py`."""

import gc
import os
import socket
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

import pytest
from tests.json_client import wait_until

from ur.run.host.protocol import GROUP, receive, send
from ur.web.server.robot_process import fork_node
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


def test_page_gets_a_node_by_the_socket_of_the_run_and_a_client_that_says_nothing_gets_none(
    link: tuple[socket.socket, int], tmp_path: Path
) -> None:
    host, descriptor = link
    path = str(tmp_path / "forks")
    server = threading.Thread(target=fork_server.main, args=([str(tmp_path), "json", str(descriptor)],))
    null = os.open(os.devnull, os.O_RDWR)
    server.start()
    wait_until(tmp_path.joinpath("forks").exists, 20.0, "the server listens", 0.01)
    with socket.socket(socket.AF_UNIX) as silent:
        silent.connect(path)
    pid = fork_node(path, "no_such_module", (null, null, null), {})
    os.close(null)
    assert pid > 1
    host.close()
    server.join(20.0)
    with pytest.raises(ConnectionRefusedError):
        fork_node(path, "no_such_module", (0, 0, 0), {})
