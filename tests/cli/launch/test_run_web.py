"""`ur run PROGRAM --web`: program and page begin and end together."""

import asyncio
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT, make_environment

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")
pytestmark = [pytest.mark.ros, pytest.mark.timeout(300)]

UR = str(ROOT / "ur")


@pytest.mark.parametrize(("option", "number"), [("--foxglove", signal.SIGINT), ("--web", signal.SIGKILL)])
def test_page_and_program_end_together(tmp_path: Path, option: str, number: signal.Signals) -> None:
    environment = make_environment(tmp_path) | {"XDG_STATE_HOME": str(tmp_path / "state")}

    def list_runs() -> str:
        done = subprocess.run([UR, "ps"], env=environment, capture_output=True, text=True, timeout=120, check=True)
        return done.stdout

    def wait(*, active: bool) -> None:
        deadline = time.monotonic() + 100.0
        while ("m_robot_base" in list_runs()) != active:
            assert time.monotonic() < deadline, log.read_text()

    if option == "--foxglove":
        pytest.importorskip("foxglove", reason="foxglove-sdk is not installed: requirements/foxglove.lock")
    log = tmp_path / "log"
    with log.open("w") as output:
        command = [UR, "run", "robot_base", option, "world:=office"]
        process = subprocess.Popen(
            command, env=environment, stdin=subprocess.DEVNULL, stdout=output, stderr=output, cwd=tmp_path
        )
    wait(active=True)
    printed = log.read_text()
    assert "login#" in printed
    address = re.search(r"ws://localhost:\S+", printed)
    assert bool(address) == (option == "--foxglove"), printed
    if address:
        asyncio.run(see_topics(address[0]))
    process.send_signal(number)
    assert process.wait(120) == (0 if number == signal.SIGINT else -number)
    wait(active=False)


async def see_topics(address: str) -> None:
    """Connect as Foxglove does, and wait until a topic of the simulated robot is offered."""
    deadline, topics = time.monotonic() + 100.0, set[str]()
    async with aiohttp.ClientSession() as client:
        while "/odom" not in topics:
            assert time.monotonic() < deadline, topics
            try:
                async with client.ws_connect(address, protocols=("foxglove.sdk.v1",), max_msg_size=0) as socket:
                    while "/odom" not in topics:
                        message = await socket.receive_json(timeout=deadline - time.monotonic())
                        topics.update(each["topic"] for each in message.get("channels", []))
            except aiohttp.WSServerHandshakeError as problem:
                if problem.status != 503:  # the robot is not connected yet
                    raise
                await asyncio.sleep(0.2)
