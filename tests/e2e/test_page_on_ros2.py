"""The page of `ur web` in a real browser, with the simulator on ROS 2."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.e2e.conftest import UrShell
from tests.e2e.web_page import PROGRAM, BrowserPage, open_first, start_server
from tests.ros2_session import PYTHON, free_domain

TITLES = ("Start", "Stop")
LAUNCH = str(Path(__file__).with_name("robot.launch"))

pytestmark = [
    pytest.mark.timeout(600),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
    pytest.mark.skipif(not PYTHON.exists(), reason="no wheels of ROS 2 for this processor"),
]
pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")


@pytest.fixture
def page(tmp_path: Path) -> Iterator[BrowserPage]:
    shell = UrShell(tmp_path)
    shell.environment |= {"ROS_DOMAIN_ID": free_domain(), "XDG_RUNTIME_DIR": str(tmp_path)}
    assert shell.ur("use", "sim", "--ros", "2").returncode == 0
    started = shell.ur("launch", "--detach", "--wait", "--timeout-ready", "200", LAUNCH)
    assert started.returncode == 0, started.stderr
    try:
        with start_server(shell.environment, tmp_path) as server, open_first(server, tmp_path) as browser:
            page = BrowserPage(browser)
            page.wait("globalThis.page?.map.tiles.tiles.size && page.map.pose && page.state && page.drive.newest")
            browser.complaints.clear()
            yield page
            assert browser.complaints == []
    finally:
        assert shell.ur("stop", "--all").returncode == 0


def test_page_shows_the_robot_and_drives_it_by_the_stick(page: BrowserPage) -> None:
    page.wait("page.map.scan.length > 50 && !page.state.missing.length")
    before = float(page.run("page.pose.x"))
    page.tap("#mode-drive")
    page.push_stick()
    page.wait(f"Math.abs(page.pose.x - {before}) > 0.05")
    page.touch("End")
    page.wait("page.drive.press === 'idle'")


def test_page_records_the_topics_of_the_robot(page: BrowserPage) -> None:
    page.run("page.panels.toggle('recordings'); 0")
    panel = "document.getElementById('recordings-panel')"
    start, stop = (f"[...{panel}.querySelectorAll('button')].find((e) => e.innerText === {each!r})" for each in TITLES)
    page.wait(f"{start} && !{start}.disabled")
    page.run(f"{start}.click(); 0")
    page.wait(f"/^Recording all topics .* [1-9][^ ]* [kM]B/m.test({panel}.innerText)")
    page.run(f"{stop}.click(); 0")
    page.wait(f"{panel}.querySelectorAll('a[download$=\".mcap\"]').length === 1")
