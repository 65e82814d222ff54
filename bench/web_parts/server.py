"""`ur web` as a process: a login, and the processes between page and base."""

from __future__ import annotations

import asyncio
import re
import time
from pathlib import Path

import aiohttp
import psutil

_BETWEEN = ("twist_mux", "stageros", "simulator", "robot_end_node", "web", "cmd_vel_mux_node", "simulator_node")


async def log_in(port: int, log: Path) -> dict[str, str]:
    """Log in with the link that `ur web` prints into a file, and return the cookies of the session."""
    deadline = time.monotonic() + 60
    while not (found := re.search(r"login#(\S+)", log.read_text())):
        assert time.monotonic() < deadline, "ur web printed no link"
        await asyncio.sleep(0.1)
    url = f"http://localhost:{port}"
    async with aiohttp.ClientSession() as session:
        answer = await session.post(f"{url}/login", json={"token": found[1]}, headers={"Origin": url})
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
