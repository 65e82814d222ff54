"""Slider, gamepad and plots of the page in a real browser; the robot's end is played by the test."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from tests.docs.chromium import Chromium, find_chromium
from tests.ros_session import free_port

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from aiohttp import web

from ur.web.access.origin import make_origins
from ur.web.access.roles import Role
from ur.web.server.application import Application
from ur.web.server.gate import Gate
from ur.web.server.static_files import load_files
from ur.web.wire.frames import Kind, Layer, PoseSample, json_frame, pose_frame

PROGRAM = find_chromium()
pytestmark = [
    pytest.mark.long,
    pytest.mark.timeout(240),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
]
PLOT = "/odom:twist.twist.linear.x"
STATE: dict[str, Any] = {
    "robot": {"base": "magni", "outline": [[0.2, 0.1], [-0.2, 0.1], [0.0, -0.1]], "limits": [0.5, 1.0]},
    "missing": [],
    "goal": {"number": 0, "place": None, "state": "none", "text": "", "left": None},
    "mux": {"stopped": False, "active": "", "asked": False, "problem": ""},
    "lease": None,
    "spread": None,
    "battery": None,
    "limit": 100,
    "bumpers": ["front"],
    "sources": ["joystick", "web"],
}
GOAL = {"number": 0, "place": [1.0, 0.0, 0.0], "state": "none", "text": "", "left": None}
GAMEPAD = """
const buttons = [...Array(16)].map(() => ({ pressed: false }));
globalThis.pad = { id: "pad", connected: true, axes: [0, 0, 0, 0], buttons };
navigator.getGamepads = () => [globalThis.pad];
dispatchEvent(new Event("gamepadconnected"));
page.setMode("drive");
0
"""


class Robot:
    """A server whose robot's end answers nothing, shows a state, and notes what pages ask for."""

    def __init__(self, folder: Path) -> None:
        self.port, self.asked = free_port(), list[Any]()
        self._gate = Gate(make_origins((), self.port), folder / "sessions.json", lambda _: None)
        environment = {"ROS_MASTER_URI": "http://localhost:1"}
        self._application = Application(self._gate, load_files(), environment, "bob", lambda _: None)
        end = self._application.robot_end
        end.run = self._play  # type: ignore[method-assign]
        end.send = self._note  # type: ignore[method-assign]
        self._ready, self._loop = threading.Event(), asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, daemon=True)

    @property
    def link(self) -> str:
        return f"http://127.0.0.1:{self.port}/login#{self._gate.invite(Role.DRIVE)}"

    def __enter__(self) -> Robot:
        self._thread.start()
        assert self._ready.wait(30)
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._over.set)
        self._thread.join(30)

    def show(self, kind: Kind, value: Mapping[str, Any]) -> None:
        self._loop.call_soon_threadsafe(self._application.show, json_frame(kind, value))

    def find(self, kind: str) -> list[Any]:
        return [each for each in self.asked if each["t"] == kind]

    def _note(self, message: Mapping[str, Any]) -> None:
        if "m" in message:
            self.asked.append(json.loads(message["m"]))

    def _run(self) -> None:
        self._loop.run_until_complete(self._serve())

    async def _serve(self) -> None:
        self._over = asyncio.Event()
        runner = web.AppRunner(self._application.build(), access_log=None, shutdown_timeout=1.0)
        await runner.setup()
        await web.TCPSite(runner, "127.0.0.1", self.port).start()
        self._ready.set()
        await self._over.wait()
        await runner.cleanup()

    async def _play(self) -> None:
        """Challenges and poses as of a robot that stands."""
        self._application.robot_end.state = "up"
        self._application.show(json_frame(Kind.STATE, STATE))
        self._application.show(json_frame(Kind.FIELDS, {"fields": {"/odom": ["twist.twist.linear.x"]}}, Layer.PLOTS))
        for count in range(1, 100_000):
            self._application._drivers.take({"n": [count, 0]})
            self._application.show(pose_frame(PoseSample(0.0, 0.0, 0.0, 0.0, 0.0, 0.01, 0.01)))
            values = {"t": count / 50, "v": {PLOT: count % 7 / 7}}
            self._application.show(json_frame(Kind.VALUES, values, Layer.PLOTS))
            await asyncio.sleep(0.02)


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Robot]:
    with Robot(tmp_path_factory.mktemp("robot")) as robot:
        yield robot


@pytest.fixture(scope="module")
def browser(robot: Robot, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    assert PROGRAM is not None
    with Chromium(PROGRAM, tmp_path_factory.mktemp("chromium")) as browser:
        browser.resize(1200, 800, phone=False)
        browser.open(robot.link)
        wait(lambda: browser.holds("globalThis.page?.state && page.drive.newest"))
        yield browser
        assert browser.complaints == []


def wait(condition: Any, seconds: float = 60.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, f"not true within {seconds:g} s"
        time.sleep(0.05)


def test_slider_limits_the_speed_when_it_is_let_go(robot: Robot, browser: Chromium) -> None:
    browser.run("page.panels.toggle('speed'); 0")
    assert browser.run("document.getElementById('speed-limit').value") == "100"
    browser.run(
        "(() => { const slider = document.getElementById('speed-limit'); slider.value = '40';"
        " slider.dispatchEvent(new Event('input')); slider.dispatchEvent(new Event('change')); })()"
    )
    wait(lambda: robot.find("limit"))
    assert robot.find("limit") == [{"t": "limit", "percent": 40}]
    assert "joystick, page" in browser.run("document.getElementById('speed-panel').textContent")
    browser.run("page.panels.close(); 0")


def test_bumper_that_is_pressed_is_named(browser: Chromium) -> None:
    wait(lambda: "Bumper pressed: front" in browser.run("document.getElementById('banners').textContent"))


def test_patrol_drives_to_the_ticked_places_in_turn_until_another_goal_is_sent(robot: Robot, browser: Chromium) -> None:
    robot.show(Kind.PLACES, {"named": True, "places": {"desk": [0, 0, 0], "door": [1, 0, 0]}, "problem": ""})
    browser.run("page.panels.toggle('places'); 0")
    wait(lambda: browser.run("document.querySelectorAll('#places-panel li').length") == 2)
    assert browser.run("document.getElementById('patrol').disabled")
    for name in ("door", "desk"):
        browser.run(f"document.querySelector('#places-panel input[aria-label=\"Patrol: {name}\"]').click(); 0")
    browser.run("document.getElementById('patrol').click(); 0")
    wait(lambda: len(robot.find("go_to")) == 1)
    robot.show(Kind.STATE, STATE | {"goal": GOAL | {"number": 1, "state": "driving"}})
    robot.show(Kind.STATE, STATE | {"goal": GOAL | {"number": 1, "state": "reached"}})
    wait(lambda: browser.holds("page.places.patrol.reachedAt < Infinity"))
    browser.run("page.places.patrol.reachedAt -= 1000; 0")
    robot.show(Kind.STATE, STATE | {"goal": GOAL | {"number": 1, "state": "reached"}})
    wait(lambda: len(robot.find("go_to")) == 2)
    assert [each["place"] for each in robot.find("go_to")] == ["door", "desk"]
    robot.show(Kind.STATE, STATE | {"goal": GOAL | {"number": 2, "state": "driving"}})
    wait(lambda: browser.run("page.places.patrol.mine") == 2)
    robot.show(Kind.STATE, STATE | {"goal": GOAL | {"number": 3, "state": "driving"}})
    wait(lambda: "The patrol ended: another goal was sent." in browser.run("document.body.innerText"))
    robot.show(Kind.STATE, STATE)
    browser.run("page.panels.close(); 0")


def test_gamepad_drives_while_its_stick_is_pushed_and_its_button_stops(robot: Robot, browser: Chromium) -> None:
    browser.run("document.hasFocus = () => true; 0")
    browser.run(GAMEPAD)
    wait(lambda: browser.run("page.gamepads.state") == "idle")
    browser.run("pad.axes = [0, -1, 0, 0]; 0")
    wait(lambda: robot.find("stick"))
    assert {each["forward"] for each in robot.find("stick")} == {0.5}
    browser.run("pad.axes = [0, 0, 0, 0]; 0")
    wait(lambda: robot.find("let_go"))
    assert robot.find("stop") == []
    browser.run("pad.buttons[1].pressed = true; 0")
    wait(lambda: robot.find("stop"))
    browser.run("pad.connected = false; page.setMode('look'); 0")


def test_plot_is_ticked_drawn_and_in_the_address(browser: Chromium, tmp_path: Path) -> None:
    browser.run("page.panels.toggle('plots'); 0")
    wait(lambda: browser.holds("document.querySelector('#plots-panel input')"))
    browser.run("document.querySelector('#plots-panel input').click(); 0")
    wait(lambda: browser.run("location.search") == f"?plots={PLOT}")
    wait(lambda: browser.run("(document.querySelector('#plots-panel output')?.textContent ?? '\u2013') !== '\u2013'"))
    assert browser.run("document.querySelector('#plots-panel canvas').ariaLabel").startswith("Speed (m/s)")
    (tmp_path / "plots.png").write_bytes(browser.screenshot())
    browser.run("globalThis.page = null; location.reload(); 0")
    wait(lambda: browser.holds("globalThis.page?.panels?.open === 'plots' && page.plots.size === 1"))
    browser.run("page.panels.close(); 0")
    assert browser.run("location.search") == ""
