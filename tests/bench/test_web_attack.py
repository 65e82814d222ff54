"""The attackers of `bench/web_attack`, all at once, on the server as a process: a session is served as if alone."""

import asyncio
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from bench.web_parts.attackers import KINDS  # noqa: E402
from bench.web_parts.server import log_in_to_look, start_attackers  # noqa: E402
from tests.web.server.test_serve import Service  # noqa: E402

from ur.web.access.roles import Role  # noqa: E402
from ur.web.server.links import admit_script, make_token  # noqa: E402

ROOT = Path(__file__).parents[2]
SECONDS, PRESSES = 8.0, 100
MOST_MEMORY, MOST_LOG = 150_000, 100_000  # kB, bytes

pytestmark = [pytest.mark.timeout(300)]


def memory_of(pid: int) -> int:
    """The most memory that a process has had, kB."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return int(next(line.split()[1] for line in lines if line.startswith("VmHWM")))


async def test_session_is_served_while_all_attackers_are_at_work(tmp_path: Path) -> None:
    service, token = Service(tmp_path), make_token()
    subprocess.run(["sh", "-c", admit_script(token, Role.DRIVE)], env=service.env, check=True)
    service.start()
    attackers = []
    try:
        _, _, cookie = service.ask("POST", "/login", json.dumps({"token": token}))
        url = f"http://127.0.0.1:{service.port}"
        headers = {"Origin": url, "Cookie": cookie}
        member = await log_in_to_look(service.port, dict([cookie.split("=", 1)]))
        async with (
            aiohttp.ClientSession(headers=headers) as session,
            session.ws_connect(f"{url}/ws/drive?tab=0123456789") as drive,
        ):
            assert (await drive.receive_json(timeout=60))["t"] == "hello"
            for kind in set(KINDS) - {"none", "site"}:  # for a site Chromium is needed
                words = [sys.executable, "-m", "bench.web_parts.attackers", kind, str(service.port)]
                env = {**os.environ, "PYTHONPATH": str(ROOT)}
                attackers.append(start_attackers([*words, "--seconds", str(SECONDS)], env, member))
            for number in range(PRESSES):
                close = {"Connection": "close"} if number % 2 else {}
                async with session.post(f"{url}/api/stop", headers=close) as answer:
                    assert answer.status == 503  # it is passed on to no robot: none runs
                    assert "the robot is not connected" in await answer.text()
                await asyncio.sleep(SECONDS / PRESSES)
            assert not drive.closed
            async with session.ws_connect(f"{url}/ws/drive?tab=9876543210") as again:
                assert (await again.receive_json(timeout=60))["t"] == "hello"
        assert memory_of(service.process.pid) < MOST_MEMORY
        assert sum(path.stat().st_size for path in tmp_path.rglob("web.log*")) < MOST_LOG
    finally:
        service.stop()
        for each in attackers:
            each.kill()
            each.wait()
