"""Recordings over the web: state and list, start, stop, download and removal; and the replay that runs."""

import asyncio
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

from aiohttp import web
from msgspec import Meta

from ur.recordings.replays import CommandName, ReplayCommand, ask_replay
from ur.run.master.client import parse_master_uri
from ur.run.master.xml_rpc import CallRefused, Unanswered, WrongServer
from ur.source.diagnostic import UserError
from ur.source.foreign.json_values import ForeignValue
from ur.system.ros import NONE, graph_address, read_domain
from ur.web.access.roles import Role
from ur.web.server.logins.gate import SESSION, demand_drive, read_body
from ur.web.server.recordings.recorder import Recorder, RecorderError, RecordingLimits, make_command
from ur.web.server.recordings.store import RecordingBusyError, Store, recordings_folder

MOST_TOPICS = 40
"""Topics that a page may choose."""

_NAME = r"^(/[A-Za-z][A-Za-z0-9_]{0,99}){1,10}\Z"


@dataclass(frozen=True, slots=True)
class PublishedTopic:
    """A published topic and its type."""

    name: str
    kind: str


class ChosenTopics(ForeignValue, frozen=True):
    """The topics that a request names; None for all."""

    topics: (
        Annotated[
            tuple[Annotated[str, Meta(pattern=_NAME)], ...],
            Meta(min_length=1, max_length=MOST_TOPICS, description=f"1 to {MOST_TOPICS} full names, such as /scan"),
        ]
        | None
    ) = None

    @property
    def names(self) -> tuple[str, ...]:
        """Return each topic once."""
        return tuple(dict.fromkeys(self.topics or ()))


def list_topics(address: str) -> tuple[PublishedTopic, ...]:
    """List the topics that are published at a master; this blocks. None are known on ROS 2, which has no master.

    Raises Unanswered, CallRefused or UserError if there is no answer of a master.
    """
    if read_domain(address) not in (None, NONE):
        return ()
    found = parse_master_uri(address).call("getPublishedTopics", "")
    if not isinstance(found, list):
        raise WrongServer("expected the topics of a ROS master")
    pairs = [each for each in found if isinstance(each, list) and len(each) == 2]
    return tuple(
        PublishedTopic(name, str(kind)[:200])
        for name, kind in sorted(pairs, key=str)
        if isinstance(name, str) and re.search(_NAME, name)
    )


@dataclass(frozen=True, slots=True)
class _ReplayRequest:
    """A command for the replay that runs."""

    name: CommandName
    value: float = 0.0


class RecordingPages:
    """The routes and their dependencies. `log` is called with a line about each action."""

    def __init__(
        self,
        environment: Mapping[str, str],
        log: Callable[[str], None],
        limits: RecordingLimits | None = None,
        command: Callable[[Mapping[str, str], Path, Sequence[str]], list[str]] = make_command,
        ask_topics: Callable[[str], tuple[PublishedTopic, ...]] = list_topics,
    ) -> None:
        self._log, self._ask_master, self._environment = log, ask_topics, environment
        self._master = graph_address(environment)
        self._store = Store(recordings_folder(environment))
        self._recorder = Recorder(self._store, environment, log, limits, command)

    def routes(self) -> list[web.RouteDef]:
        """Return the routes."""
        return [
            web.get("/api/recordings", self._describe),
            web.get("/api/recordings/topics", self._list_topics),
            web.get("/api/recordings/file", self._download),
            web.post("/api/recordings/start", self._start),
            web.post("/api/recordings/stop", self._stop),
            web.post("/api/recordings/delete", self._delete),
            web.get("/api/replay", self._describe_replay),
            web.post("/api/replay", self._control_replay),
        ]

    async def close(self) -> None:
        """End the recording in progress."""
        await self._recorder.close()

    async def _describe(self, request: web.Request) -> web.Response:
        """Return the recording in progress, why the last one ended, and, with the right to drive, the files."""
        running = self._recorder.running
        value: dict[str, object] = {"running": asdict(running) if running else None, "end": self._recorder.end}
        if request[SESSION][1].role is Role.DRIVE:
            if running is None:
                with suppress(RecordingBusyError, OSError), self._store.lock():
                    self._store.adopt()
            value["files"] = [asdict(each) for each in self._store.list()]
        return web.json_response(value)

    async def _list_topics(self, request: web.Request) -> web.Response:
        demand_drive(request)
        return web.json_response([asdict(each) for each in await self._ask_topics()])

    async def _start(self, request: web.Request) -> web.Response:
        """Start recording all topics except pictures and clouds, or those that the request names."""
        demand_drive(request)
        chosen = (await read_body(request, ChosenTopics)).names
        await self._ask_topics()
        try:
            self._recorder.start(chosen)
        except RecorderError as problem:
            raise web.HTTPConflict(text=f"{problem}\n") from None
        self._note(request, f"records {', '.join(chosen) or 'all topics but pictures and clouds'}")
        return web.json_response({"ok": True})

    async def _stop(self, request: web.Request) -> web.Response:
        demand_drive(request)
        if not await self._recorder.stop(f"stopped by {request[SESSION][1].name}"):
            raise web.HTTPConflict(text="nothing is recorded\n")
        self._note(request, "stops the recording")
        return web.json_response({"ok": True})

    async def _download(self, request: web.Request) -> web.StreamResponse:
        """Send a file in chunks, as fast as the page receives it."""
        demand_drive(request)
        path = self._store.find(request.query.get("id"))
        if path is None:
            raise web.HTTPNotFound(text="there is no recording of this name\n")
        self._note(request, f"downloads {path.name}")
        disposition = f'attachment; filename="{path.name}"'  # a name of ours
        return web.FileResponse(
            path, headers={"Content-Disposition": disposition, "Content-Type": "application/octet-stream"}
        )

    async def _delete(self, request: web.Request) -> web.Response:
        demand_drive(request)
        path = self._store.find((await read_body(request, dict)).get("id"))
        if path is None:
            raise web.HTTPNotFound(text="there is no recording of this name\n")
        self._note(request, f"deletes {path.name}")
        try:
            path.unlink(missing_ok=True)
        except OSError as problem:
            raise web.HTTPConflict(text=f"{path.name}: {(problem.strerror or str(problem)).lower()}\n") from None
        return web.json_response({"ok": True})

    async def _describe_replay(self, _request: web.Request) -> web.Response:
        """Return the state of the replay that runs on this computer; null if there is none."""
        return await self._ask_replay(ReplayCommand("state"))

    async def _control_replay(self, request: web.Request) -> web.Response:
        """Pause it, let it go on, jump, or change its speed; return its state then."""
        demand_drive(request)
        asked = await read_body(request, _ReplayRequest)
        return await self._ask_replay(ReplayCommand(asked.name, asked.value))

    async def _ask_replay(self, command: ReplayCommand) -> web.Response:
        loop = asyncio.get_running_loop()
        state = await loop.run_in_executor(None, ask_replay, command, self._environment)
        return web.json_response(asdict(state) if state else None)

    async def _ask_topics(self) -> tuple[PublishedTopic, ...]:
        """List the topics. Raises HTTPConflict if no master answers."""
        try:
            return await asyncio.get_running_loop().run_in_executor(None, self._ask_master, self._master)
        except (Unanswered, CallRefused, UserError):
            raise web.HTTPConflict(text="the robot is not connected: start a program of it\n") from None

    def _note(self, request: web.Request, what: str) -> None:
        self._log(f"{request.remote} ({request[SESSION][1].name}): {what}")
