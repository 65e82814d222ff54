"""Figures of the page on one computer, each beside its limit: delays, sizes, processor time, memory, frame times."""

from __future__ import annotations

import asyncio
import io
import json
import math
import random
import statistics
import struct
import tempfile
import threading
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import aiohttp
import psutil
import rospy
from bench.web_parts.drawing import Drawing, measure_drawing, percentile
from geometry_msgs.msg import Twist
from PIL import Image
from sensor_msgs.msg import CompressedImage
from tests.chromium import Chromium, find_chromium

from ur.web.server.static_files import load_files

FORWARD = 0.05  # m/s of a press
PRESSES, PICTURES = 60, 60
OVER = 10.0  # s over which processor time is measured
FRAME = 1000 / 60  # ms


@dataclass(frozen=True)
class Figure:
    """A measured value and its limit."""

    name: str
    value: float
    limit: float
    unit: str


async def measure_stick(session: Any, url: str) -> float:
    """Seconds from a command of a page to the first velocity on cmd_vel, 95th percentile of presses."""
    arrived = threading.Event()

    def note(message: Twist) -> None:
        if message.linear.x:
            arrived.set()

    subscriber = rospy.Subscriber("cmd_vel", Twist, note, queue_size=1, tcp_nodelay=True)
    delays = []
    async with session.ws_connect(f"{url}/ws/drive?tab=0123456789", headers={"Origin": url}) as socket:
        for hold in range(1, PRESSES + 1):
            began, refused = math.inf, False
            arrived.clear()
            end = time.monotonic() + 2.0
            while not arrived.is_set() and not refused and time.monotonic() < end:
                value = (await socket.receive()).json()
                refused = value.get("t") == "over"
                if "n" in value:
                    began = min(began, time.monotonic())
                    forward = FORWARD if hold % 2 else -FORWARD
                    command = {"t": "stick", "n": value["n"], "hold": hold, "forward": forward, "turn": 0.0}
                    await socket.send_str(json.dumps(command))
                    await asyncio.to_thread(arrived.wait, 0.02)
            if arrived.is_set():
                delays.append(time.monotonic() - began)
            await socket.send_str(json.dumps({"t": "let_go", "hold": hold}))
            rest = time.monotonic() + random.uniform(0.3, 0.5)
            while time.monotonic() < rest:  # challenges go on
                await socket.receive()
    subscriber.unregister()
    return percentile(delays, 0.95) if delays else math.inf


async def measure_camera(session: Any, url: str) -> float:
    """Seconds from the publication of a picture of 640 x 480 to its arrival at a page, 95th percentile."""
    publisher = rospy.Publisher("raspicam_node/image/compressed", CompressedImage, queue_size=1)
    buffer = io.BytesIO()
    Image.effect_noise((640, 480), 60).convert("RGB").save(buffer, "JPEG", quality=70)
    ended = threading.Event()

    def publish() -> None:
        while not ended.wait(1 / 15):
            message = CompressedImage(format="jpeg", data=buffer.getvalue())
            message.header.stamp = rospy.Time.from_sec(time.time())
            publisher.publish(message)

    thread = threading.Thread(target=publish, daemon=True)
    thread.start()
    ages = []
    async with session.ws_connect(f"{url}/ws/camera", headers={"Origin": url}, max_msg_size=0) as socket:
        for _ in range(PICTURES):
            data = (await asyncio.wait_for(socket.receive(), 30)).data
            ages.append(time.time() - struct.unpack_from("<d", data, 6)[0])
            await socket.send_str("shown")
    ended.set()
    thread.join()
    publisher.unregister()
    return percentile(ages[5:], 0.95)


async def measure_viewers(session: Any, url: str, server: psutil.Process, count: int) -> float:
    """The share of a core that server and robot's end take while this many pages look."""

    async def look() -> None:
        async with session.ws_connect(f"{url}/ws/view", headers={"Origin": url}, max_msg_size=0) as socket:
            async for _ in socket:
                pass

    pages = [asyncio.create_task(look()) for _ in range(count)]
    await asyncio.sleep(2.0)
    before, began = _used(server), time.monotonic()
    await asyncio.sleep(OVER)
    share = (_used(server) - before) / (time.monotonic() - began)
    for page in pages:
        page.cancel()
    await asyncio.gather(*pages, return_exceptions=True)
    return share


def _used(server: psutil.Process) -> float:
    """Processor seconds of a process and all below it, those that have ended among them."""
    total = 0.0
    for each in (server, *server.children(recursive=True)):
        with suppress(psutil.NoSuchProcess):  # it has just ended: its parent has its time
            total += sum(each.cpu_times()[:4])
    return total


def measure_browser(url: str, cookie: dict[str, str]) -> tuple[float, list[Drawing]]:
    """Seconds until a page shows the map, median of 5 loads, and the drawing of a large map."""
    program = find_chromium()
    assert program is not None, "Chromium is not installed"
    with tempfile.TemporaryDirectory() as folder, Chromium(program, Path(folder)) as browser:
        browser.resize(1400, 900)
        for name, value in cookie.items():
            browser.ask("Network.setCookie", name=name, value=value, url=url, httpOnly=True)
        loads = []
        for _ in range(5):
            browser.open(f"{url}/")
            shown = browser.run(
                "new Promise((done, fail) => { const look = () => globalThis.page?.map.tiles.tiles.size"
                " ? requestAnimationFrame(() => done(performance.now())) : performance.now() > 30000"
                " ? fail('the page shows no map after 30 s') : setTimeout(look, 4); look(); })"
            )
            loads.append(shown / 1000)
        return statistics.median(loads), measure_drawing(browser)


def measure_panels(url: str, cookie: dict[str, str], server: psutil.Process) -> float:
    """The share of a core that the server and its processes use while a page shows all layers and the most panels."""
    program = find_chromium()
    assert program is not None, "Chromium is not installed"
    options = ("--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader")
    with tempfile.TemporaryDirectory() as folder, Chromium(program, Path(folder), *options) as browser:
        browser.resize(1600, 1000)
        for name, value in cookie.items():
            browser.ask("Network.setCookie", name=name, value=value, url=url, httpOnly=True)
        browser.open(f"{url}/")
        browser.run(
            "new Promise((done) => { const look = () => { if (!globalThis.page?.state) return setTimeout(look, 100);"
            " page.panels.show(['layers']); document.querySelectorAll('#layers-panel input:not(:checked)')"
            ".forEach((each) => each.click());"
            " page.panels.show(['camera', 'plots', 'scene', 'topics']); show(); }; const show = () => "
            " page.scenePanel?.view?.model.length && page.topicPanel && document.querySelector('[data-plot]')"
            " ? done(document.querySelectorAll('[data-plot]').forEach((each) => each.click()) ?? 0)"
            " : setTimeout(show, 100); look(); })"
        )
        before, began = _used(server), time.monotonic()
        time.sleep(OVER)
        return (_used(server) - before) / (time.monotonic() - began)


async def measure_all(port: int, cookie: dict[str, str], server: psutil.Process) -> list[Figure]:
    """All figures of a server whose robot runs."""
    url = f"http://localhost:{port}"
    first, drawings = await asyncio.to_thread(measure_browser, url, cookie)
    panels = await asyncio.to_thread(measure_panels, url, cookie, server)
    size = sum(len(each.packed) for each in load_files().values()) / 1000
    jar = aiohttp.CookieJar(unsafe=True)
    async with aiohttp.ClientSession(cookies=cookie, cookie_jar=jar) as session:
        jar.update_cookies(cookie)
        one = await measure_viewers(session, url, server, 1)
        ten = await measure_viewers(session, url, server, 10)
        stick = await measure_stick(session, url)
        camera = await measure_camera(session, url)
    memory = server.memory_full_info().pss / 1e6
    return [
        Figure("stick to cmd_vel, p95", 1000 * stick, 60, "ms"),
        Figure("first picture of the map", first, 1.5, "s"),
        Figure("page, compressed, with all panels", size, 150, "kB"),
        Figure("camera to page, 640 x 480, p95", 1000 * camera, 250, "ms"),
        Figure("one viewer", 100 * one, 8, "% of a core"),
        Figure("ten viewers", 100 * ten, 25, "% of a core"),
        Figure("all layers, four panels with 3D view", 100 * panels, 25, "% of a core"),
        Figure("memory of the server", memory, 60, "MB"),
        # Frames come at whole multiples of the screen's interval, give or take some tenths of a millisecond.
        *(Figure(f"4000 x 4000, {each.view}: frame, p95", each.frame, 1.1 * FRAME, "ms") for each in drawings),
        *(Figure(f"4000 x 4000, {each.view}: processor", each.processor, FRAME, "ms a frame") for each in drawings),
    ]


def print_figures(figures: list[Figure]) -> bool:
    """Print a table. Return whether all are within their limits."""
    for each in figures:
        mark = "" if each.value <= each.limit else "  ABOVE"
        print(f"{each.name:45} {each.value:8.2f} of {each.limit:6.4g} {each.unit}{mark}")
    return all(each.value <= each.limit for each in figures)
