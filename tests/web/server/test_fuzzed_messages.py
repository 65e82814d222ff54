"""Malformed messages over real web sockets.

More of them: UR_WEB_FUZZ=100000 ./test tests/web/server/test_fuzzed_messages.py
"""

import json
import os
import random
from pathlib import Path
from typing import Any

import pytest
from tests.fuzz.mutate import mutate
from tests.ros_session import free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.server.robot_processes import KeptRobotEnd, keep  # noqa: E402

from ur.web.access.origin import make_origins  # noqa: E402
from ur.web.access.roles import Role  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import open_server  # noqa: E402
from ur.web.server.connections.listener import listen  # noqa: E402
from ur.web.server.logins.gate import LoginGate  # noqa: E402
from ur.web.server.run_pages import RunPages  # noqa: E402
from ur.web.wire import run_requests  # noqa: E402
from ur.web.wire.requests import LONGEST, read_request  # noqa: E402
from ur.web.wire.run_requests import read_run_request  # noqa: E402

COUNT = int(os.environ.get("UR_WEB_FUZZ", "300"))
A_PAGE = 15  # messages of one connection: fewer than those after which it is closed
WORDS = (b"NaN", b"1e999", b"-1", b"null", b"[", b"{", b'"', b"\\u0000", b"\x00", b"\xff", b"4294967296", b'"n":[1,2],')
VALID: tuple[dict[str, Any], ...] = (
    {"t": "alive", "n": [1, 2]},
    {"t": "stick", "n": [1, 2], "hold": 1, "forward": 0.5, "turn": 0.1},
    {"t": "goal", "n": [1, 2], "x": 1, "y": 2, "yaw": 0.5},
    {"t": "go_to", "n": [1, 2], "place": "door"},
    {"t": "name_place", "place": "door", "x": 1, "y": 2, "yaw": 0},
    {"t": "lease", "n": [1, 2], "do": "take"},
)


@pytest.mark.timeout(max(60, COUNT // 10))
async def test_only_requests_that_are_well_formed_reach_the_robot(tmp_path: Path) -> None:
    port, chance, log, ends = free_port(), random.Random(COUNT), list[str](), list[KeptRobotEnd]()
    gate = LoginGate(make_origins((), port), tmp_path / "sessions.json", log.append)
    environment = {"ROS_MASTER_URI": f"http://localhost:{free_port()}"}
    application = Application(gate, {}, environment, "bob", log.append, make_robot_process=keep(ends))
    url, seeds = f"http://127.0.0.1:{port}", [json.dumps(each).encode() for each in VALID]
    async with (
        open_server(application.build(), gate, listen("127.0.0.1", port), log.append),
        aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True), headers={"Origin": url}) as client,
    ):
        await (await client.post(f"{url}/login", json={"token": gate.invite(Role.DRIVE)})).release()
        for page in range(0, COUNT, A_PAGE):
            async with client.ws_connect(f"{url}/ws/drive?tab={page:08d}") as socket:
                assert (await socket.receive_json(timeout=30))["t"] == "hello"
                for _ in range(A_PAGE):
                    data = mutate(seeds, WORDS, chance)[: LONGEST - 1]  # longer ones close the page
                    if chance.random() < 0.2:
                        await socket.send_bytes(data)
                    else:
                        await socket.send_str(data.decode("utf-8", "replace")[: LONGEST // 3])
                await socket.send_str('{"t": "cancel"}')
                await socket.ping()
                await socket.close()
        answer = await client.get(f"{url}/api/me")
        assert (await answer.json())["role"] == "drive"
    requests = [each["m"] for each in ends[0].passed if "m" in each]
    assert requests.count('{"t": "cancel"}') == len(range(0, COUNT, A_PAGE))  # each page is heard to its end
    for each in requests:
        assert read_request(each)
    assert not any("Traceback" in line for line in log)


RUN_WORDS = (*WORDS, b"$(eval 1)", b":=", b"--detach", b"../", b"\\n", b'"arguments":{}', b"4294967295")
PATHS = ("graph", "nodes", "explain")
VALID_RUNS: tuple[dict[str, Any], ...] = (
    {"t": "start", "n": 1, "id": 1, "program": "make_map", "arguments": {"world": "office", "x": "1.0"}},
    {"t": "node", "n": 1, "id": 2, "run": "m_make_map.12", "node": "/amcl", "do": "restart"},
    {"t": "end", "n": 1, "id": 3, "run": "m_make_map.12"},
)


class NotedRunPages(RunPages):
    """Pages that note what they would carry out."""

    done: list[Any]

    def _carry_out(self, *given: Any) -> None:
        self.done.append(given[2])


@pytest.mark.timeout(max(60, COUNT // 10))
async def test_only_run_requests_that_are_well_formed_are_carried_out(tmp_path: Path) -> None:
    port, chance, log = free_port(), random.Random(COUNT), list[str]()
    gate = LoginGate(make_origins((), port), tmp_path / "sessions.json", log.append, pace=(1e6, 1e6))
    environment = {"ROS_MASTER_URI": f"http://localhost:{free_port()}", "HOME": str(tmp_path)}
    runs = NotedRunPages(environment, log.append, pace=(1e6, 1e6))
    done: list[Any] = []
    runs.done = done
    built = Application(gate, {}, environment, "bob", log.append, runs=runs).build()
    url, seeds = f"http://127.0.0.1:{port}", [json.dumps(each).encode() for each in VALID_RUNS]
    async with (
        open_server(built, gate, listen("127.0.0.1", port), log.append),
        aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True), headers={"Origin": url}) as client,
    ):
        await (await client.post(f"{url}/login", json={"token": gate.invite(Role.DRIVE)})).release()
        for _ in range(0, COUNT, A_PAGE):
            async with client.ws_connect(f"{url}/ws/runs") as socket:
                assert await socket.receive_json(timeout=30) == {"t": "beat", "n": 1}
                for _ in range(A_PAGE):
                    data = mutate(seeds, RUN_WORDS, chance)[: run_requests.LONGEST // 3]
                    if chance.random() < 0.2:
                        await socket.send_bytes(data)
                    else:
                        await socket.send_str(data.decode("utf-8", "replace"))
                await socket.send_str(json.dumps(VALID_RUNS[2]))
                await socket.close()
        bad = ("program=--x", "program=a&arguments=[]", "program=a&arguments={", "x=%00")
        for query in (*(f"{path}?{each}" for path in PATHS for each in bad), "explain?program=a&node=../x"):
            answer = await client.get(f"{url}/api/{query}")
            assert answer.status == 400, query
            assert "Traceback" not in await answer.text()
    last = read_run_request(json.dumps(VALID_RUNS[2])).request
    assert done.count(last) >= len(range(0, COUNT, A_PAGE))  # each page is heard to its end
    for each in done:
        assert type(each) in (run_requests.StartProgram, run_requests.ChangeNode, run_requests.EndRun)
        assert "$(" not in str(each)
    assert not any("Traceback" in line for line in log)
