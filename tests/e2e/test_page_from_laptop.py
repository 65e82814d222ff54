"""The page that a robot serves by itself, in a browser of a laptop that has nothing else."""

import os
import re
import shlex
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.chromium import Chromium
from tests.cut_network import ADDRESSES, CutNetwork, can_make_networks, cut_network
from tests.e2e.conftest import ROOT, end
from tests.e2e.web_page import PROGRAM, BrowserPage

pytestmark = [
    pytest.mark.timeout(300),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
    pytest.mark.skipif(not can_make_networks(), reason="making network namespaces needs root"),
]


def command_on(network: CutNetwork, side: str, *command: str) -> list[str]:
    """A command, in the network of a side."""
    return ["nsenter", f"--net=/proc/{network.holders[side].pid}/ns/net", "--", *command]


@contextmanager
def robot_program(network: CutNetwork, folder: Path, *arguments: str) -> Iterator[Path]:
    """A command of `ur` on the robot, with a simulated base and no ROS; the file of what it prints."""
    environment = {
        "HOME": str(folder),
        "PATH": os.environ["PATH"],
        "UR_ROBOT": "sim:stage --ros none",
        "XDG_RUNTIME_DIR": str(folder / "run"),
    }
    log = folder / f"{arguments[0]}.log"
    with log.open("w") as output:
        command = command_on(network, "robot", str(ROOT / "ur"), *arguments)
        process = subprocess.Popen(
            command, env=environment, stdin=subprocess.PIPE, stdout=output, stderr=output, text=True
        )
    try:
        yield log
    finally:
        end(process)


@contextmanager
def laptop_browser(network: CutNetwork, folder: Path) -> Iterator[BrowserPage]:
    """A browser of the laptop, on its desk."""
    starter = folder / "browser"
    starter.write_text(f'#!/bin/sh\nexec {shlex.join(command_on(network, "laptop", str(PROGRAM)))} "$@"\n')
    starter.chmod(0o755)
    with Chromium(str(starter), folder) as browser:
        browser.resize(1200, 800)
        yield BrowserPage(browser)


def send_key(page: BrowserPage, kind: str, **more: object) -> None:
    page.browser.ask("Input.dispatchKeyEvent", type=kind, key="w", code="KeyW", **more)


def hold_key(page: BrowserPage, until: str) -> None:
    """Hold W until an expression is true; press it again where a busy computer was too slow for a press."""
    for _ in range(30):
        send_key(page, "keyDown", text="w")
        page.wait(f"{until} || page.drive.press !== 'held'")
        if page.run(until):
            return
        send_key(page, "keyUp")
    raise AssertionError(f"the key does not drive: {page.explain()}")


def read_link(log: Path, page: BrowserPage) -> str:
    while (found := re.search(r"http://\S+/login#\S+", log.read_text())) is None:
        page.run("new Promise((done) => setTimeout(done, 200))")
    return found[0]


def test_laptop_with_a_browser_alone_drives_a_robot_that_serves_its_page(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir(mode=0o700)
    (tmp_path / "browser_home").mkdir()
    with cut_network() as network:
        subprocess.run(
            command_on(network, "robot", "ip", "route", "add", "default", "via", ADDRESSES["laptop"]), check=True
        )
        with (
            robot_program(network, tmp_path, "run", "keyboard_navigate"),
            robot_program(network, tmp_path, "web", "--phone", "--no-browser") as log,
            laptop_browser(network, tmp_path / "browser_home") as page,
        ):
            link = read_link(log, page)
            assert link.startswith(f"http://{ADDRESSES['robot']}:8090/")
            page.browser.open(link)
            page.wait("globalThis.page?.map.pose && page.state && page.drive.newest", 120.0)
            page.run("document.querySelector('#mode-drive').click()")
            before = page.run("page.pose.x")
            hold_key(page, f"page.pose.x > {before + 0.2}")
            network.cut()
            page.wait("document.body.innerText.includes('No connection to the server.')")
            network.restore()
            send_key(page, "keyUp")
            page.wait("page.poseAge < 1 && Math.abs(page.pose.speed) < 0.01")
            assert before + 0.2 < page.run("page.pose.x") < before + 1.5
