"""A server in the master's place is named soon; a master that is busy is waited for; a port that is free is used."""

import os
import socket
import threading
import xmlrpc.client
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import pytest
from tests.forking import run_ur

from ur.run.master.client import Master, format_master_uri
from ur.run.master.search import Patience, find_listener, find_master, read_run_id
from ur.run.options import RunOptions
from ur.run.output.console import Console
from ur.source import UserError

ID = xmlrpc.client.dumps(([1, "", "the id"],), methodresponse=True).encode()
LAUNCH = '<launch>\n  <node name="a" pkg="rosout" type="rosout"/>\n</launch>\n'


class Warnings(Console):
    """Keeps what was warned of."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = []

    def warn(self, text: str) -> None:
        self.lines.append(text)


@contextmanager
def server(*answers: bytes | None) -> Iterator[Master]:
    """A server that gives its callers one answer each, and the last one to all others; None: silence."""
    kept: list[socket.socket] = []

    def serve() -> None:
        waiting = list(answers)
        with suppress(OSError):
            while True:
                link, _ = listener.accept()
                answer = waiting.pop(0) if len(waiting) > 1 else waiting[0]
                if answer is None:
                    kept.append(link)
                    continue
                with link:
                    link.recv(65536)
                    link.sendall(answer)

    with socket.create_server(("localhost", 0)) as listener:
        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        port = listener.getsockname()[1]
        yield Master(format_master_uri("localhost", port), "localhost", port)
        listener.shutdown(socket.SHUT_RDWR)
    thread.join(60)
    for link in kept:
        link.close()


QUICK = Patience(named=0.1, busy=0.5)


@pytest.mark.parametrize("answer", [None, b"", b"HTTP/1.0 404 Not Found\r\n\r\n", b"SSH-2.0-OpenSSH\r\n" * 9999])
def test_server_that_is_no_master_is_named_with_its_process(answer: bytes | None) -> None:
    console = Warnings()
    with server(answer) as master, pytest.raises(UserError) as caught:
        read_run_id(master, RunOptions(), console, QUICK)
    [problem] = caught.value.diagnostics
    assert f"does not answer as a ROS master listens on localhost:{master.port}" in problem.message
    assert f"process {os.getpid()})" in problem.message
    assert f"ur launch -p {master.port + 1}" in str(problem.help)


def test_server_that_takes_no_more_connections_is_named_with_its_process() -> None:
    with socket.create_server(("localhost", 0), backlog=0) as listener, ExitStack() as waiting:
        port = listener.getsockname()[1]
        for _ in range(4):  # the kernel accepts one or two of them
            link = waiting.enter_context(socket.socket())
            link.setblocking(False)
            link.connect_ex(("localhost", port))
        with pytest.raises(UserError, match=f"listens on localhost:{port} ") as caught:
            read_run_id(
                Master(format_master_uri("localhost", port), "localhost", port), RunOptions(), Warnings(), QUICK
            )
    assert f"process {os.getpid()})" in caught.value.diagnostics[0].message


def test_busy_master_is_named_and_then_used() -> None:
    console = Warnings()
    with server(None, b"HTTP/1.0 200 OK\r\n\r\n" + ID) as master:
        assert read_run_id(master, RunOptions(), console) == "the id"
    assert len(console.lines) == 1
    assert "a server that does not answer" in console.lines[0]


def test_silent_server_is_waited_for_when_asked_to() -> None:
    console = Warnings()
    with server(*[None] * 12, b"HTTP/1.0 200 OK\r\n\r\n" + ID) as master:
        assert read_run_id(master, RunOptions(wait_for_master=True), console) == "the id"


def test_free_port_lets_a_master_be_started() -> None:
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        port = probe.getsockname()[1]
        assert read_run_id(Master("", "localhost", port), RunOptions(), Warnings()) is None
        assert find_listener(port) is None


def test_other_port_keeps_the_brackets_of_an_ipv6_address() -> None:
    master = find_master({"ROS_MASTER_URI": "http://[::1]:11311"}, RunOptions(port=11400))
    assert (master.uri, master.host, master.port) == ("http://[::1]:11400", "::1", 11400)


@pytest.mark.ros
def test_launch_names_the_silent_server_and_starts_nothing(tmp_path: Path) -> None:
    (tmp_path / "a.launch").write_text(LAUNCH)
    with server(None) as master:
        environment = {**os.environ, "ROS_MASTER_URI": master.uri, "HOME": str(tmp_path)}
        done = run_ur("launch", "--plain", "a.launch", folder=tmp_path, environment=environment)
    assert done.returncode in (1, 2)
    first, *others = done.stderr.splitlines()
    assert first.startswith("a server that does not answer as a ROS master listens on localhost:")
    assert "master started here" not in done.stderr
    assert "did not answer within" not in done.stderr
    assert any(line.startswith("error: a server that does not answer") for line in others)


@pytest.mark.ros
def test_master_that_cannot_listen_on_ipv6_is_not_started(tmp_path: Path) -> None:
    (tmp_path / "a.launch").write_text(LAUNCH)
    environment = {**os.environ, "ROS_MASTER_URI": "http://[::1]:11397", "HOME": str(tmp_path), "ROS_IPV6": ""}
    done = run_ur("launch", "--plain", "a.launch", folder=tmp_path, environment=environment)
    assert "does not listen on IPv6" in done.stderr
    assert "help: export ROS_IPV6=on" in done.stderr
