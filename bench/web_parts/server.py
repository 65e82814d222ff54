"""`ur web` as a process: a login, and the processes between page and base."""

import asyncio
import re
import subprocess
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import aiohttp
import psutil

_BETWEEN = ("twist_mux", "stageros", "simulator", "robot_endpoint_node", "web", "cmd_vel_mux_node", "simulator_node")


async def log_in(port: int, log: Path) -> dict[str, str]:
    """Log in with the link that `ur web` prints into a file, and return the cookies of the session."""
    deadline = time.monotonic() + 60
    while not (found := re.search(r"login#(\S+)", log.read_text())):
        assert time.monotonic() < deadline, "ur web printed no link"
        await asyncio.sleep(0.1)
    return await _log_in(port, found[1])


async def log_in_to_look(port: int, cookie: dict[str, str]) -> str:
    """Log in with a link that a session makes for watching, and return the header `Cookie`."""
    url = f"http://localhost:{port}"
    async with (
        aiohttp.ClientSession(cookies=cookie, headers={"Origin": url}) as session,
        session.post(f"{url}/api/invite", json={"role": "look"}) as answer,
    ):
        link = (await answer.json())["link"]
    return "; ".join(f"{name}={value}" for name, value in (await _log_in(port, link.rpartition("#")[2])).items())


def start_attackers(command: Sequence[str], env: Mapping[str, str], cookie: str) -> subprocess.Popen[str]:
    """Start attackers of a kind, see `attackers`; the kind `member` has the cookie."""
    started = subprocess.Popen(command, cwd=Path(__file__).parents[2], env=env, stdin=subprocess.PIPE, text=True)
    assert started.stdin is not None, "a pipe"
    with started.stdin:
        started.stdin.write(cookie + "\n")
    return started


async def _log_in(port: int, token: str) -> dict[str, str]:
    url = f"http://localhost:{port}"
    async with aiohttp.ClientSession() as session:
        answer = await session.post(f"{url}/login", json={"token": token}, headers={"Origin": url})
        assert answer.status == 200, await answer.text()
        return {name: value.value for name, value in answer.cookies.items()}


def list_between() -> list[int]:
    """List the processes below this one that take part in what happens between page and base."""
    return [each.pid for each in psutil.Process().children(recursive=True) if _is_between(each)]


def waited_main(pid: int) -> float:
    """Time in s that the main thread of a process has waited for a processor; 0 once it is dead."""
    try:
        return int(Path(f"/proc/{pid}/task/{pid}/schedstat").read_text().split()[1]) / 1e9
    except OSError:
        return 0.0


def _is_between(process: psutil.Process) -> bool:
    try:
        words = process.cmdline()
    except psutil.NoSuchProcess:
        return False
    return any(word.rpartition("/")[2].rpartition(".")[2] in _BETWEEN for word in words)
