"""The panel of devices in a real browser: a second one is invited, named and logged out."""

from pathlib import Path

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS, PROGRAM
from tests.web.static.played_robot import wait

pytestmark = MARKS
PANEL = "document.getElementById('devices-panel')"


def press(browser: Chromium, text: str) -> None:
    button = f"[...{PANEL}.querySelectorAll('button')].find((e) => e.textContent === {text!r})"
    browser.run(f"{button}.click(); 0")


def test_second_device_is_invited_by_a_code_and_logged_out_again(browser: Chromium, tmp_path: Path) -> None:
    browser.run("page.panels.toggle('devices'); 0")
    wait(lambda: browser.run(f"{PANEL}.querySelectorAll('li').length") == 1)
    assert browser.run(f"{PANEL}.querySelector('li').textContent").startswith("Linuxthis device")
    press(browser, "Invite to look")
    wait(lambda: browser.holds(f"{PANEL}.querySelector('img')?.naturalWidth"))
    (tmp_path / "devices.png").write_bytes(browser.screenshot())
    link = browser.run(f"{PANEL}.querySelector('pre').textContent")
    assert PROGRAM is not None
    with Chromium(PROGRAM, tmp_path / "second") as second:
        second.open(link)
        wait(lambda: second.holds("globalThis.page?.state && page.socket"))
        assert not second.holds("page.mayDrive")
        second.run("page.panels.toggle('devices'); 0")
        assert second.run(f"[...{PANEL}.querySelectorAll('button')].map((e) => e.textContent).join()").endswith(
            "Name it,Log out all others,Invite to look"
        )
        second.run(f"{PANEL}.querySelector('input').value = 'Ada'; {PANEL}.querySelector('form').requestSubmit(); 0")
        wait(lambda: "called Ada" in second.run(f"{PANEL}.textContent"))
        browser.run("page.panels.toggle('devices'); page.panels.toggle('devices'); 0")
        wait(lambda: browser.holds(f"{PANEL}.querySelector('[aria-label=\"Log out Ada\"]')"))
        for _ in range(2):
            browser.run(f"{PANEL}.querySelector('[aria-label$=\"Log out Ada\"]').click(); 0")
        wait(lambda: second.run("location.pathname") == "/login")
    wait(lambda: browser.run(f"{PANEL}.querySelectorAll('li').length") == 1)
    browser.run("page.panels.toggle('devices'); 0")
    assert not browser.holds(f"{PANEL}.querySelector('img')")
