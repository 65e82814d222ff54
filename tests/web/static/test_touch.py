"""The page with a finger, in a real browser; the robot's end is played by the test."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.docs.chromium import Chromium
from tests.e2e.web_page import PHONE, PROGRAM, Page
from tests.web.static.played_robot import Robot

pytestmark = [
    pytest.mark.long,
    pytest.mark.timeout(240),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    assert PROGRAM is not None
    with (
        Robot(tmp_path_factory.mktemp("robot")) as robot,
        Chromium(PROGRAM, tmp_path_factory.mktemp("chromium")) as browser,
    ):
        browser.resize(*PHONE, phone=True)
        browser.ask("Emulation.setTouchEmulationEnabled", enabled=True)
        browser.open(robot.link)
        page = Page(browser)
        page.wait("globalThis.page?.state && page.map.pose && page.drive.newest")
        yield page
        assert browser.complaints == []


@pytest.mark.parametrize(("mode", "where"), [("look", "#map"), ("goal", "#map"), ("drive", "#stick")])
def test_first_tap_after_a_quick_drag_counts(page: Page, mode: str, where: str) -> None:
    page.run(f"page.setMode('{mode}'); 0")
    x, y = page.middle(where)
    page.touch("Start", x, y)
    page.touch("Move", x, y - 55)
    page.touch("End")
    page.tap("#mode-pose")
    page.wait("page.mode === 'pose'", 20)
