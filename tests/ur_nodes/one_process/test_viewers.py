"""The socket at which viewers ask for nodes."""

import socket
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from ur_nodes.one_process.viewers import ViewerSocket, ask, read_module

LIMIT = 20.0  # s


class Answers:
    """Answers each request by a line, over the socket that has come with it."""

    def __init__(self) -> None:
        self.words: list[Sequence[str]] = []

    def run(self, words: Sequence[str]) -> None:
        self.words.append(words[:1])
        with socket.socket(fileno=int(words[1])) as link:
            link.sendall(b"hello")


@pytest.fixture
def answers() -> Answers:
    return Answers()


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answers: Answers) -> Iterator[str]:
    monkeypatch.chdir(tmp_path)  # a short path: sockets have no long ones
    viewers = ViewerSocket("run/nodes.sock", answers.run)
    yield "run/nodes.sock"
    viewers.close()
    assert not Path("run/nodes.sock").exists()


def read_all(link: socket.socket) -> bytes:
    link.settimeout(LIMIT)
    data = b""
    while part := link.recv(100):
        data += part
    return data


def test_viewer_gets_a_node_with_its_socket_until_the_node_ends(path: str, answers: Answers) -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs, ask(path, "ur_nodes.web.robot_endpoint_node", [theirs.fileno()]) as connection:
        assert read_all(connection) == b""
        assert read_all(ours) == b"hello"
    assert answers.words == [["ur_nodes.web.robot_endpoint_node"]]


def test_viewer_that_asks_for_something_else_gets_nothing(path: str, answers: Answers) -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs, ask(path, "ur_nodes.simulator.simulator_node", [theirs.fileno()]) as connection:
        theirs.close()
        assert read_all(connection) == read_all(ours) == b""
    assert answers.words == []


@pytest.mark.parametrize(
    "text",
    [b"", b"{", b"[]", b"{}", b'{"module": 3}', b'{"module": "os"}', b'{"module": "ur_nodes.web./x.py"}', b"\xff"],
)
def test_request_that_names_no_module_of_the_page_is_none(text: bytes) -> None:
    assert read_module(text) == ""


def test_folder_of_the_socket_is_private_and_a_path_without_a_run_answers_nothing(path: str) -> None:
    assert Path(path).parent.stat().st_mode & 0o077 == 0
    with pytest.raises(OSError, match="No such file"):
        ask("elsewhere", "ur_nodes.web.robot_endpoint_node", [])
