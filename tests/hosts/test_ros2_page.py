"""The page of a robot with ROS 2, in a browser of a laptop without any ROS. Kilted: its wheels read transforms."""

import re
import shlex
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.chromium import Chromium
from tests.e2e.web_page import PHONE, PROGRAM, BrowserPage
from tests.hosts.bench import REPOSITORY, Bench, Machine
from tests.hosts.test_ros2_driving import AT_REST, key_held, last_motion, program, set_up_pair

pytestmark = [pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed")]


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    with set_up_pair("kilted", "--transforms", f"{REPOSITORY}/src") as bench:
        yield bench


@contextmanager
def browser_of(laptop: Machine, folder: Path) -> Iterator[BrowserPage]:
    """A browser on a phone, in the network of the laptop."""
    starter = folder / "browser"
    words = ["nsenter", "--target", str(laptop.leader), "--net", "--", str(PROGRAM)]
    starter.write_text(f'#!/bin/sh\nexec {shlex.join(words)} "$@"\n')
    starter.chmod(0o755)
    with Chromium(str(starter), folder) as browser:
        browser.resize(*PHONE, phone=True)
        browser.ask("Emulation.setTouchEmulationEnabled", enabled=True)
        yield BrowserPage(browser)


@pytest.mark.timeout(900)
def test_page_shows_the_robot_while_keys_drive_it_and_a_cut_of_the_network_stops_the_base(
    pair: Bench, tmp_path: Path
) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    for name in ("keys", "web"):
        (tmp_path / name).mkdir()
    with (
        program(laptop, "run keyboard_drive obstacle_stop:=false", tmp_path / "keys") as keys,
        program(laptop, "web --no-browser", tmp_path / "web") as web,
        browser_of(laptop, tmp_path) as page,
    ):
        keys.until("hold a key", 120.0)
        link = re.search(r"http://localhost:8090/login#\S+", web.until("http://localhost:8090/login#", 120.0))
        assert link
        page.browser.open(link[0])
        page.wait("globalThis.page?.map.pose && page.map.scan.length > 50 && page.state?.lease", 120.0)
        with key_held(keys, "i"):
            page.wait("page.pose.x > 0.3 && page.pose.speed > 0.1")
            (tmp_path / "page.png").write_bytes(page.browser.screenshot())
            laptop.cut()
            cut = time.monotonic()
            try:
                page.wait("document.body.innerText.includes('No connection to the server.')")
                assert last_motion(robot) - cut <= AT_REST
            finally:
                laptop.restore()
        assert not page.browser.faults
