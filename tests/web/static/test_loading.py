"""A page of which a file does not arrive, as when the network changes while it is loaded."""

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import wait

pytestmark = MARKS


@pytest.mark.parametrize("file", ["gamepad.js", "main.js", "layout.css"])
def test_page_of_which_a_file_is_lost_says_so_and_loads_itself_again(browser: Chromium, file: str) -> None:
    browser.ask("Network.enable")
    browser.ask("Network.setCacheDisabled", cacheDisabled=True)
    browser.ask("Network.setBlockedURLs", urls=[f"*/{file}"])
    browser.run("globalThis.page = null; location.reload(); 0")
    wait(lambda: browser.holds("document.getElementById('empty')?.innerText.includes('did not arrive')"))
    browser.ask("Network.setBlockedURLs", urls=[])
    wait(lambda: browser.holds("globalThis.page?.state && document.getElementById('empty').hidden"))
    assert all(each.startswith("Failed to load resource") for each in browser.complaints)
    browser.complaints.clear()
    browser.ask("Network.setCacheDisabled", cacheDisabled=False)
