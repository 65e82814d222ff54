"""Check of ROS masters: a connection to each, within a limit, at most once in some seconds."""

from __future__ import annotations

import asyncio
import socket
import time
from collections.abc import Collection
from concurrent.futures import ThreadPoolExecutor
from urllib.parse import urlsplit

LIMIT = 1.0
"""Seconds that a master has to answer."""

_FRESH = 3.0  # s for which a result is good
_THREADS = 8  # a name may take longer to resolve than the limit


class MastersCheck:
    """The results, by the masters' URIs. Nothing is asked between calls of `check`."""

    def __init__(self) -> None:
        self._threads = ThreadPoolExecutor(_THREADS, "masters")
        self._found: dict[str, tuple[float, bool]] = {}
        self._running: dict[str, asyncio.Future[None]] = {}

    async def check(self, masters: Collection[str]) -> frozenset[str]:
        """Return the masters that answer. One that has not within the limit is not waited for."""
        for master in masters:
            at = self._found.get(master, (float("-inf"), False))[0]
            if master not in self._running and time.monotonic() - at > _FRESH:
                self._running[master] = asyncio.ensure_future(self._check_one(master))
        waiting = [self._running[each] for each in masters if each in self._running]
        if waiting:
            await asyncio.wait(waiting, timeout=LIMIT)
        return frozenset(
            each for each in masters if each not in self._running and self._found.get(each, (0.0, False))[1]
        )

    def close(self) -> None:
        """End the checks."""
        for task in self._running.values():
            task.cancel()
        self._threads.shutdown(wait=False, cancel_futures=True)

    async def _check_one(self, master: str) -> None:
        try:
            found = await asyncio.get_running_loop().run_in_executor(self._threads, answers, master)
            self._found[master] = time.monotonic(), found
        finally:
            del self._running[master]


def answers(master: str) -> bool:
    """Return whether the port of a master takes a connection within the limit."""
    try:
        address = urlsplit(master)
        with socket.create_connection((address.hostname or "", address.port or 11311), LIMIT):
            return True
    except (OSError, ValueError):
        return False
