"""Headless Chromium, driven over a pair of pipes with its DevTools protocol: no port, no driver, no network."""

from __future__ import annotations

import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import time
from pathlib import Path
from types import TracebackType
from typing import Any

PROGRAMS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
PATIENCE = 60.0  # s, for anything that the browser is asked


def find_chromium() -> str | None:
    """The program; None where there is none, or only a stand-in for a snap."""
    for name in PROGRAMS:
        path = shutil.which(name)
        if path is not None and b"/snap/" not in Path(path).read_bytes()[:2000]:
            return path
    return None


class ChromiumError(RuntimeError):
    """The browser refuses a request."""


class Chromium:
    """A browser with one page. What pages write to the console as an error is in `complaints`."""

    def __init__(self, program: str, folder: Path, *more: str) -> None:
        """Start it with a profile in a folder; `more` are options of its command line."""
        low_read, our_write = os.pipe()
        our_read, low_write = os.pipe()
        to_browser, from_browser = (fcntl.fcntl(each, fcntl.F_DUPFD_CLOEXEC, 20) for each in (low_read, low_write))
        os.close(low_read)
        os.close(low_write)
        # The protocol's pipes are descriptors 3 and 4; bash puts them there.
        script = f'exec "$@" 3<&{to_browser} 4>&{from_browser} {to_browser}<&- {from_browser}>&-'
        options = [
            "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--remote-debugging-pipe",
            "--no-first-run", "--disable-background-networking", "--disable-extensions", "--mute-audio",
            "--disable-component-update", "--hide-scrollbars", f"--user-data-dir={folder / 'profile'}", *more,
            "about:blank",
        ]  # fmt: skip
        self._process = subprocess.Popen(
            ["bash", "-c", script, "bash", program, *options],
            pass_fds=(to_browser, from_browser),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "HOME": str(folder), "XDG_CONFIG_HOME": str(folder), "XDG_CACHE_HOME": str(folder)},
            start_new_session=True,
        )
        os.close(to_browser)
        os.close(from_browser)
        self._read, self._write = our_read, our_write
        self._buffer = b""
        self._number = 0
        self._session = ""
        self._events: list[dict[str, Any]] = []
        self.complaints: list[str] = []

    def __enter__(self) -> Chromium:
        pages = self.ask("Target.getTargets")["targetInfos"]
        page = next(each for each in pages if each["type"] == "page")
        attached = self.ask("Target.attachToTarget", targetId=page["targetId"], flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.ask(f"{domain}.enable")
        return self

    @property
    def pid(self) -> int:
        """The process of the browser."""
        return self._process.pid

    @property
    def faults(self) -> list[str]:
        """The complaints, but for those of drawing in three dimensions without a graphics card."""
        return [each for each in self.complaints if "software WebGL" not in each and "ReadPixels" not in each]

    def kill(self) -> None:
        """End it at once, as a crash does."""
        os.killpg(self._process.pid, 9)
        self._process.wait(timeout=60)

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._write)  # ends it
        try:
            self._process.wait(timeout=60)
        except subprocess.TimeoutExpired:
            os.killpg(self._process.pid, 9)
            self._process.wait(timeout=60)
        os.close(self._read)

    def ask(self, method: str, **parameters: object) -> dict[str, Any]:
        """Ask the browser and wait for its answer."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        number = self._number
        answer = self._wait(lambda each: each.get("id") == number, method)
        if "error" in answer:
            raise ChromiumError(f"{method}: {answer['error']}")
        result: dict[str, Any] = answer.get("result", {})
        return result

    def open(self, url: str) -> None:
        """Go to a page and wait until it is loaded."""
        self._events.clear()
        answer = self.ask("Page.navigate", url=url)
        assert "errorText" not in answer, f"{url}: {answer['errorText']}"
        self.wait_for_load()

    def wait_for_load(self) -> None:
        """Wait for the page's load event."""
        for each in self._events:
            if each.get("method") == "Page.loadEventFired":
                self._events.clear()
                return
        self._wait(lambda each: each.get("method") == "Page.loadEventFired", "loading")
        self._events.clear()

    def holds(self, expression: str) -> bool:
        """Whether an expression is true; False while the page is exchanged for another one."""
        try:
            return bool(self.run(f"Boolean({expression})"))
        except ChromiumError as problem:
            if "navigated" not in str(problem):
                raise
            return False

    def run(self, script: str) -> Any:
        """The value of an expression on the page."""
        answer = self.ask("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def press(self, key: str, text: str = "") -> None:
        """Press and let go of a key: `ArrowDown`, `Escape`, or a character."""
        code = {"Enter": 13, "Escape": 27, "Tab": 9, "ArrowDown": 40, "ArrowUp": 38, " ": 32}.get(key, 0)
        text = text or (key if len(key) == 1 else "\r" if key == "Enter" else "")
        common = {
            "key": key,
            "code": "Space" if key == " " else "",
            "windowsVirtualKeyCode": code,
            "nativeVirtualKeyCode": code,
        }
        self.ask("Input.dispatchKeyEvent", type="keyDown", text=text, **common)
        self.ask("Input.dispatchKeyEvent", type="keyUp", **common)

    def write(self, text: str) -> None:
        """Type a text, key by key."""
        for character in text:
            self.press(character)

    def resize(self, width: int, height: int, *, phone: bool = False) -> None:
        """The size of the page in CSS pixels."""
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)

    def prefer(self, scheme: str) -> None:
        """Light or dark, as the computer would be set."""
        self.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def screenshot(self) -> bytes:
        """A PNG of what is seen."""
        return base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"])

    def _wait(self, wanted: Any, what: str) -> dict[str, Any]:
        deadline = time.monotonic() + PATIENCE
        while True:
            while b"\0" in self._buffer:
                raw, _, self._buffer = self._buffer.partition(b"\0")
                message: dict[str, Any] = json.loads(raw)
                self._note(message)
                if wanted(message):
                    return message
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self._read], [], [], left)[0]:
                raise TimeoutError(f"Chromium did not answer {what} within {PATIENCE:g} s")
            data = os.read(self._read, 1 << 20)
            if not data:
                raise RuntimeError(f"Chromium ended while it was asked for {what}")
            self._buffer += data

    def _note(self, message: dict[str, Any]) -> None:
        method, parameters = message.get("method"), message.get("params", {})
        if method == "Page.loadEventFired":
            self._events.append(message)
        elif method == "Runtime.exceptionThrown":
            self.complaints.append(str(parameters["exceptionDetails"]))
        elif method == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
            entry = parameters["entry"]
            if "ERR_NETWORK_CHANGED" not in entry["text"]:  # other tests make networks; pages load themselves again
                self.complaints.append(f"{entry['text']} {entry.get('url', '')}")
        elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
            self.complaints.append(str(parameters["args"]))
