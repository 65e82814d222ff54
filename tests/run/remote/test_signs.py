import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ur.run.master.client import Master
from ur.run.remote.protocol import Client
from ur.run.remote.signs import START_SECONDS, Sign, has_viewer, judge_client, look_up_nodes, probe_node, read_signs

OLD = Client("a1", "laptop", "m1", 7, ("/keys", "/view"), since=1000.0)
LATER = 1000.0 + START_SECONDS + 1


@pytest.fixture
def closed_port() -> Iterator[int]:
    with socket.socket() as held:  # bound and not listening: nobody else gets it, and it refuses
        held.bind(("127.0.0.1", 0))
        yield held.getsockname()[1]


@pytest.mark.parametrize(
    ("nodes", "now", "sign"),
    [
        ({"/keys": Sign.PRESENT, "/view": Sign.ENDED}, LATER, Sign.PRESENT),
        ({"/keys": Sign.SILENT, "/view": Sign.ENDED}, LATER, Sign.SILENT),
        ({"/keys": Sign.ENDED, "/view": None}, LATER, Sign.ENDED),
        ({"/keys": None, "/view": None}, LATER, Sign.ENDED),
        ({"/keys": None, "/view": None}, 1001.0, Sign.SILENT),
        ({"/keys": Sign.ENDED, "/view": None}, 1001.0, Sign.SILENT),
    ],
)
def test_client_is_judged_by_its_nodes(nodes: dict[str, Sign | None], now: float, sign: Sign) -> None:
    assert judge_client(OLD, nodes, now) is sign


def test_computer_that_refuses_the_connection_says_that_the_node_is_gone(closed_port: int) -> None:
    assert probe_node(f"http://127.0.0.1:{closed_port}/") is Sign.ENDED


@pytest.mark.parametrize("uri", ["", "rosrpc://x:1", "http://no-such-host.invalid:1/", "http://x"])
def test_address_that_leads_nowhere_says_nothing(uri: str) -> None:
    assert probe_node(uri) is Sign.SILENT


def test_clients_are_silent_while_no_master_answers(closed_port: int) -> None:
    master = Master("", "127.0.0.1", closed_port, 1.0)
    detached = Client("d", "laptop", "m1", 7, detached=True)
    follower = Client("no-such-client", "laptop", "m1", 7)
    signs = read_signs([OLD, detached, follower], master, time.time())
    assert signs == {"a1": Sign.SILENT, "d": Sign.PRESENT, "no-such-client": Sign.SILENT}


def test_viewer_of_a_client_is_known_by_its_environment(tmp_path: Path) -> None:
    (tmp_path / "12").mkdir()
    (tmp_path / "12/environ").write_bytes(b"HOME=/x\0UR_CLIENT=a1\0")
    (tmp_path / "self").mkdir()
    assert has_viewer("a1", str(tmp_path))
    assert not has_viewer("a", str(tmp_path))


@pytest.mark.parametrize("answer", [[], ["http://a:1", "http://b:2", "http://c:3"], None])
def test_answer_of_a_master_that_does_not_fit_the_question_is_none(answer: Any) -> None:
    class Odd(Master):
        def call_many(self, _calls: object) -> Any:
            return answer

    with pytest.raises(LookupError):
        look_up_nodes(["/keys", "/view"], Odd("", "bob", 1))
