"""A server whose robot's end is played by the test, for pages in a real browser."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.ros_session import free_port

from ur.mcp.grants import grant_files
from ur.web.access.origin import make_origins
from ur.web.access.roles import Role
from ur.web.server.application import Application
from ur.web.server.connections.http_server import open_server
from ur.web.server.connections.listener import listen
from ur.web.server.logins.gate import LoginGate
from ur.web.server.static_files import load_files
from ur.web.wire.frames import Kind, Layer, PoseSample, json_frame, pose_frame

PLOT = "/odom:twist.twist.linear.x"
STATE: dict[str, Any] = {
    "robot": {"base": "magni", "outline": [[0.2, 0.1], [-0.2, 0.1], [0.0, -0.1]], "limits": [0.5, 1.0, 0.0]},
    "missing": [],
    "goal": {"number": 0, "place": None, "state": "none", "text": "", "left": None},
    "mux": {"stopped": False, "active": "", "asked": False, "problem": ""},
    "lease": None,
    "spread": None,
    "battery": None,
    "limit": 100,
    "bumpers": ["front"],
    "sources": ["joystick", "web"],
    "cameras": {"topic": "/front/image", "topics": ["/front/image", "/rear/image"]},
}


class PlayedRobot:
    """A server whose robot's end answers nothing, shows a state, and notes what pages ask for."""

    def __init__(self, folder: Path) -> None:
        self.port, self.asked, self._running = free_port(), list[Any](), True
        self._gate = LoginGate(make_origins((), self.port), folder / "sessions.json", lambda _: None)
        environment = {"ROS_MASTER_URI": "http://localhost:1", "XDG_STATE_HOME": str(folder)}
        self.assistants = grant_files(environment)
        self._application = Application(self._gate, load_files(), environment, "bob", lambda _: None)
        end = self._application.robot_process
        end.run = self._play  # type: ignore[method-assign]
        end.send = self._note  # type: ignore[method-assign]
        self._ready, self._loop = threading.Event(), asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, daemon=True)

    @property
    def link(self) -> str:
        return f"http://127.0.0.1:{self.port}/login#{self._gate.invite(Role.DRIVE)}"

    def __enter__(self) -> PlayedRobot:
        self._thread.start()
        assert self._ready.wait(30)
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._over.set)
        self._thread.join(30)

    def show(self, kind: Kind, value: Mapping[str, Any]) -> None:
        self._loop.call_soon_threadsafe(self._application.show, json_frame(kind, value))

    @contextmanager
    def ended(self) -> Iterator[None]:
        """No master answers, so that the robot's end sends nothing."""
        self._running = False
        self._loop.call_soon_threadsafe(self._application.robot_process._enter, "no master")
        yield
        self._running = True
        self._loop.call_soon_threadsafe(self._begin)

    def move(self, selection: str) -> None:
        """Another selection, or none, leads to other nodes."""
        self._application._moved = lambda: selection

    @property
    def camera(self) -> str:
        """The topic that a page has chosen."""
        return self._application._cameras.topic

    def find(self, kind: str) -> list[Any]:
        return [each for each in self.asked if each["t"] == kind]

    def _note(self, message: Mapping[str, Any]) -> None:
        if "m" in message:
            self.asked.append(json.loads(message["m"]))

    def _run(self) -> None:
        self._loop.run_until_complete(self._serve())

    async def _serve(self) -> None:
        self._over = asyncio.Event()
        async with open_server(self._application.build(), self._gate, listen("127.0.0.1", self.port), lambda _: None):
            self._ready.set()
            await self._over.wait()

    def _begin(self) -> None:
        self._application.robot_process._enter("up")
        self._application.show(json_frame(Kind.STATE, STATE))
        self._application.show(json_frame(Kind.FIELDS, {"fields": {"/odom": ["twist.twist.linear.x"]}}, Layer.PLOTS))

    async def _play(self) -> None:
        """Challenges and poses as of a robot that stands."""
        self._begin()
        for count in range(1, 100_000):
            if not self._running:
                await asyncio.sleep(0.02)
                continue
            self._application._drivers.process({"n": [count, 0]})
            self._application.show(pose_frame(PoseSample(0.0, 0.0, 0.0, 0.0, 0.0, 0.01, 0.01)))
            values = {"t": count / 50, "v": {PLOT: count % 7 / 7}}
            self._application.show(json_frame(Kind.VALUES, values, Layer.PLOTS))
            await asyncio.sleep(0.02)


def wait(condition: Any, seconds: float = 60.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, f"not true within {seconds:g} s"
        time.sleep(0.05)
