"""The panel of assistants in a real browser: one asks to drive, is let drive, and its grant is taken back."""

import json
import os
from pathlib import Path

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import PlayedRobot, wait

from ur.mcp.grants import Request, ServerRecord

pytestmark = MARKS
PANEL = "document.getElementById('assistants-panel')"
ID = "0123abcd"


def press(browser: Chromium, text: str, within: str = PANEL) -> None:
    button = f"[...{within}.querySelectorAll('button')].find((e) => e.textContent === {text!r} && e.checkVisibility())"
    wait(lambda: browser.holds(button))
    browser.run(f"{button}.click(); 0")


def test_assistant_is_let_drive_with_areas_and_its_grant_is_taken_back(
    robot: PlayedRobot, browser: Chromium, tmp_path: Path
) -> None:
    robot.assistants.note_server(ID, ServerRecord(os.getpid(), "Claude", Request(30.0, 0.2, "to look at the door")))
    wait(lambda: "Claude asks to drive" in browser.run("document.querySelector('#banners').innerText"))
    press(browser, "Answer", "document.getElementById('banners')")
    wait(lambda: browser.holds(f"{PANEL}.querySelector('form').checkVisibility()"))
    assert browser.run(f"{PANEL}.querySelector('#assistant-minutes').value") == "30"
    sides = json.dumps(["4", "2", "1", "3"])
    browser.run(
        f"{PANEL}.querySelector('details').open = true;"
        f"{PANEL}.querySelectorAll('.rectangle .sides input').forEach((each, index) => {{"
        f" each.value = {sides}[index]; each.dispatchEvent(new Event('input')); }});"
        f"{PANEL}.querySelector('fieldset > input').value = 'kitchen'; 0"
    )
    press(browser, "Not here")
    wait(lambda: "not in kitchen (2 1 to 4 3)" in browser.run(f"{PANEL}.innerText"))
    (tmp_path / "asks.png").write_bytes(browser.screenshot())
    browser.run(f"{PANEL}.querySelector('form').requestSubmit(); 0")
    wait(lambda: robot.assistants.find(ID) is not None)
    grant = robot.assistants.find(ID)
    assert grant is not None
    assert (grant.speed, [each.name for each in grant.avoid], grant.programs) == (0.2, ["kitchen"], False)
    wait(
        lambda: "Claude may drive: at most 0.2 m/s until" in browser.run("document.querySelector('#banners').innerText")
    )
    (tmp_path / "granted.png").write_bytes(browser.screenshot())
    press(browser, "Take back", "document.getElementById('banners')")
    wait(lambda: robot.assistants.find(ID) is None)
    robot.assistants.forget_server(ID)
    wait(lambda: "No assistant is connected." in browser.run(f"{PANEL}.innerText"))
    browser.run("page.panels.toggle('assistants'); 0")
