"""Servers of assistants that are reached over HTTP: one for each login of an assistant, while it is used."""

from __future__ import annotations

import asyncio
import importlib
import os
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING

from aiohttp import web

from ur.web.runs.commands import CommandQueue
from ur.web.server.assistants.asgi import AsgiApplication, answer

if TYPE_CHECKING:
    from ur.mcp.grants import GrantFiles
    from ur.mcp.robot_link import ProcessLink

_MOST = 4  # each has a process of its own beside the robot
_IDLE = 1800.0  # s without a request
_START_LIMIT = 20.0  # s
_INSTALL_LIMIT = 300.0  # s


@dataclass(slots=True)
class _Served:
    """A server: the task that runs it, its application once it has started, and its last request (s)."""

    task: asyncio.Task[None]
    started: asyncio.Future[AsgiApplication]
    used: float
    open: int = 0


class AssistantServers:
    """Starts the server of a login with its first request. `make_link` makes its link to the robot."""

    def __init__(
        self,
        environment: Mapping[str, str],
        files: GrantFiles,
        log: Callable[[str], None],
        make_link: Callable[[Mapping[str, str], Callable[[str], None]], ProcessLink] | None = None,
    ) -> None:
        self._environment, self._files, self._log = environment, files, log
        self._make_link = make_link
        self._commands = CommandQueue(environment)
        self._served: dict[str, _Served] = {}

    async def prepare(self) -> None:
        """Install what assistants need, where that was never done. Raises HTTPServiceUnavailable."""
        importlib.invalidate_caches()
        if find_spec("mcp") is not None:
            return
        done = await self._commands.run("mcp", "--prepare", limit=_INSTALL_LIMIT)
        importlib.invalidate_caches()
        if find_spec("mcp") is None:
            lines = [line for line in done.err.splitlines() if line.startswith("error: ")] or ["error: no answer"]
            text = f"what assistants need cannot be installed: {lines[-1].removeprefix('error: ')[:300]}\n"
            raise web.HTTPServiceUnavailable(text=text)

    async def serve(self, request: web.Request, session: str, name: str) -> web.StreamResponse:
        """Answer a request of the assistant that is logged in by a session, under its name."""
        served = self._served.get(session)
        if served is None:
            if len(self._served) >= _MOST:
                raise web.HTTPServiceUnavailable(text=f"{_MOST} assistants are connected, expected no more\n")
            started: asyncio.Future[AsgiApplication] = asyncio.get_running_loop().create_future()
            task = asyncio.create_task(self._run(session, name, started))
            served = self._served[session] = _Served(task, started, time.monotonic())
        served.open += 1
        try:
            application = await asyncio.wait_for(asyncio.shield(served.started), _START_LIMIT)
            from ur.mcp.http import LONGEST

            return await answer(request, application, LONGEST)
        except asyncio.TimeoutError:
            raise web.HTTPServiceUnavailable(text="the server of assistants does not start, see the log\n") from None
        finally:
            served.open -= 1
            served.used = time.monotonic()

    def poll(self, sessions: Collection[str]) -> None:
        """End the servers of logins that have ended, and those that are not used any more."""
        now = time.monotonic()
        for session, each in self._served.items():
            if session not in sessions or (not each.open and now - each.used > _IDLE):
                each.task.cancel()

    async def close(self) -> None:
        """End all servers, and with them their grants."""
        tasks = [each.task for each in self._served.values()]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _run(self, session: str, name: str, started: asyncio.Future[AsgiApplication]) -> None:
        try:
            await self.prepare()
            # Beside the event loop: the modules take a second of a processor, which the stick must not wait for.
            await asyncio.get_running_loop().run_in_executor(None, importlib.import_module, "ur.mcp.http")
            from ur.mcp.assistant import Assistant
            from ur.mcp.http import open_assistant
            from ur.mcp.robot_link import ProcessLink, robot_environment

            link = (self._make_link or ProcessLink)(robot_environment(self._environment), self._log)
            async with open_assistant(Assistant(link, self._files, os.getpid()), name, link.close) as application:
                self._log(f"{name}: an assistant is connected")
                started.set_result(application)
                await asyncio.Event().wait()
        except web.HTTPException as problem:
            started.set_exception(problem)
        finally:
            self._served.pop(session, None)
            if not started.done():
                started.set_exception(web.HTTPServiceUnavailable(text="the server of this assistant has ended\n"))
            started.exception()  # no request may wait for it
