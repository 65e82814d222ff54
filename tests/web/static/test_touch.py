"""The page with a finger, in a real browser; the robot's end is played by the test."""

import pytest

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.chromium import Chromium
from tests.e2e.web_page import PHONE, BrowserPage
from tests.web.static.in_chromium import MARKS

pytestmark = MARKS


@pytest.fixture(scope="module")
def page(browser: Chromium) -> BrowserPage:
    browser.resize(*PHONE, phone=True)
    browser.ask("Emulation.setTouchEmulationEnabled", enabled=True)
    return BrowserPage(browser)


@pytest.mark.parametrize(("mode", "where"), [("look", "#map"), ("goal", "#map"), ("drive", "#stick")])
def test_first_tap_after_a_quick_drag_counts(page: BrowserPage, mode: str, where: str) -> None:
    page.run(f"page.setMode('{mode}'); 0")
    x, y = page.middle(where)
    page.touch("Start", x, y)
    page.touch("Move", x, y - 55)
    page.touch("End")
    page.tap("#mode-pose")
    page.wait("page.mode === 'pose'", 20)
