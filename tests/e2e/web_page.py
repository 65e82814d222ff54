"""The page of `ur web` in a real browser, as somebody with one finger uses it."""

import re
import subprocess
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.chromium import Chromium, find_chromium
from tests.e2e.conftest import ROOT, end
from tests.ros_session import free_port

PROGRAM = find_chromium()
PHONE = (390, 844)


class BrowserPage:
    """The page on a phone, with one finger."""

    def __init__(self, browser: Chromium) -> None:
        self.browser = browser
        self.touched = False

    def run(self, script: str) -> Any:
        return self.browser.run(script)

    def wait(self, script: str, seconds: float = 150.0) -> None:
        """Wait until an expression is true."""
        deadline = time.monotonic() + seconds
        while not self.browser.holds(script):
            assert time.monotonic() < deadline, f"{script}: not true within {seconds:g} s; {self.explain()}"
            time.sleep(0.1)

    def explain(self) -> Any:
        shown = "[location.pathname, document.readyState, document.body.innerText]"
        told = self.run(f"JSON.stringify([globalThis.page?.state, globalThis.page?.server, ...{shown}])")
        return told, self.browser.complaints

    def middle(self, selector: str) -> tuple[float, float]:
        x, y = self.browser.run(
            f"(() => {{ const box = document.querySelector('{selector}').getBoundingClientRect();"
            " return [box.left + box.width / 2, box.top + box.height / 2]; })()"
        )
        return x, y

    def touch(self, kind: str, *point: float) -> None:
        if kind == "End" and not self.touched:
            return
        self.touched = kind != "End"
        points = [{"x": point[0], "y": point[1]}] if point else []
        self.browser.ask("Input.dispatchTouchEvent", type=f"touch{kind}", touchPoints=points)

    def tap(self, selector: str) -> None:
        point = self.middle(selector)
        self.touch("Start", *point)
        self.touch("End")

    def tap_panel(self, name: str) -> None:
        """Open a panel by the menu, or close it."""
        if self.run(f"page.panels.isOpen('{name}')"):
            self.tap(f"#{name}-panel .close")
        else:
            self.tap("#menu")
            if not self.run(f"document.getElementById('{name}').checkVisibility()"):
                self.tap(f"details:has(#{name}) > summary")
            self.tap(f"#{name}")

    def press_banner(self, text: str) -> None:
        """Tap a button of a line above the map as soon as it is there."""
        button = f"[...document.querySelectorAll('.banner button')].find((e) => e.textContent === '{text}')"
        self.wait(button)
        x, y = self.run(
            f"(() => {{ const box = {button}.getBoundingClientRect();"
            " return [box.left + box.width / 2, box.top + box.height / 2]; })()"
        )
        self.touch("Start", x, y)
        self.touch("End")

    def push_stick(self) -> None:
        """Push the stick up, again and again until it drives: a busy computer may be too slow for a press."""
        x, y = self.middle("#stick")
        for _ in range(20):
            self.touch("Start", x, y)
            self.touch("Move", x, y - 55)
            deadline = time.monotonic() + 3.0
            while time.monotonic() < deadline and self.run("page.drive.press") == "held":
                if self.run("page.poseAge < 0.3 && page.pose.speed > 0.05"):
                    return
            self.touch("End")
        raise AssertionError(f"the stick does not drive: {self.explain()}")


@contextmanager
def start_server(env: Mapping[str, str], folder: Path) -> Iterator[tuple[int, Path]]:
    """`ur web`: its port, and the file of what it prints."""
    port, log = free_port(), folder / "web.log"
    command = [str(ROOT / "ur"), "web", "--port", str(port), "--no-browser"]
    with log.open("w") as output:
        process = subprocess.Popen(
            command, env=env, stdin=subprocess.DEVNULL, stdout=output, stderr=output, text=True, cwd=folder
        )
    try:
        deadline = time.monotonic() + 60
        while "login#" not in log.read_text():
            assert process.poll() is None, log.read_text()
            assert time.monotonic() < deadline, "ur web printed no link"
            time.sleep(0.1)
        yield port, log
    finally:
        end(process)


@contextmanager
def open_first(server: tuple[int, Path], folder: Path) -> Iterator[Chromium]:
    """A browser on a phone that has logged in by the link that the server has printed."""
    assert PROGRAM is not None
    with Chromium(PROGRAM, folder) as browser:
        browser.resize(*PHONE, phone=True)
        browser.ask("Emulation.setTouchEmulationEnabled", enabled=True)
        link = re.search(r"http\S+", server[1].read_text())
        assert link
        browser.open(link[0])
        yield browser


@contextmanager
def open_second(page: BrowserPage, server: tuple[int, Path], folder: Path) -> Iterator[BrowserPage]:
    """A page in a browser of its own, which is logged in as the first one."""
    site = f"http://localhost:{server[0]}"
    (cookie,) = page.browser.ask("Network.getCookies", urls=[site])["cookies"]
    assert PROGRAM is not None
    with Chromium(PROGRAM, folder) as browser:
        browser.resize(*PHONE, phone=True)
        browser.ask("Emulation.setTouchEmulationEnabled", enabled=True)
        browser.ask("Network.setCookie", name=cookie["name"], value=cookie["value"], url=site, httpOnly=True)
        browser.open(f"{site}/")
        other = BrowserPage(browser)
        other.wait("globalThis.page?.map.pose && page.state && page.drive.newest")
        yield other
