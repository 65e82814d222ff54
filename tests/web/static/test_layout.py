"""The parts of the page on every size of screen: nothing covers a control, and fingers can hit each of them."""

from __future__ import annotations

from typing import Any

import pytest
from tests.docs.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import STATE, Robot, wait

from ur.web.wire.frames import Kind

pytestmark = MARKS
PHONES = [(390, 844), (360, 640), (844, 390), (640, 360)]
WIDE = [(820, 1180), (1440, 900), (720, 450)]  # a tablet, a desk, and a desk that is zoomed to 200 %
LEASE = {
    "state": "held", "client": "x", "name": "a-laptop", "program": "keyboard_navigate", "since": 1.0, "until": None,
    "asking": [],
}  # fmt: skip
BUSY = STATE | {
    "bumpers": [],
    "mux": STATE["mux"] | {"stopped": True},
    "lease": LEASE,
    "goal": {"number": 7, "place": [1.0, 0.0, 0.0], "state": "driving", "text": "", "left": 24.0},
}
# Controls of which the middle, or a point near the middle of an edge, is covered or outside.
COVERED = """(selector) => [...document.querySelectorAll(selector)].filter((e) => e.checkVisibility()).filter((e) => {
  const { left, right, top, bottom } = e.getBoundingClientRect(), x = (left + right) / 2, y = (top + bottom) / 2;
  const points = [[x, y], [left + 4, y], [right - 4, y], [x, top + 4], [x, bottom - 4]];
  return points.some(([px, py]) => !e.contains(document.elementFromPoint(px, py)));
}).map((e) => e.id || e.textContent)"""
SMALL = """(least) => [...document.querySelectorAll("button, select, summary, label:has(input), input")]
  .filter((e) => e.checkVisibility() && !e.parentElement.matches("label"))
  .filter((e) => { const box = e.getBoundingClientRect(); return Math.min(box.width, box.height) < least - 0.1; })
  .map((e) => `${e.id || e.ariaLabel || e.textContent}`)"""


def set_size(browser: Chromium, size: tuple[int, int]) -> None:
    """Change the size of the page, and wait until it is laid out anew."""
    touch = size in PHONES
    browser.resize(*size, phone=touch)
    browser.ask("Emulation.setTouchEmulationEnabled", enabled=touch)
    browser.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def list_covered(browser: Chromium, selector: str) -> Any:
    return browser.run(f"({COVERED})({selector!r})")


@pytest.mark.parametrize("size", [*PHONES, *WIDE])
def test_no_control_covers_another_while_lines_are_shown(
    robot: Robot, browser: Chromium, size: tuple[int, int]
) -> None:
    robot.show(Kind.STATE, BUSY)
    wait(lambda: browser.run("document.querySelectorAll('.banner').length") == 2)
    set_size(browser, size)
    for mode in ("look", "goal", "drive", "pose"):
        browser.run(f"page.setMode('{mode}'); 0")
        assert list_covered(browser, "body > button, body > nav button, #stick, #goal button, .banner button") == []
    browser.run("page.setMode('look'); 0")


@pytest.mark.parametrize("size", [*PHONES, *WIDE])
def test_whole_map_is_shown_between_the_bars(browser: Chromium, size: tuple[int, int]) -> None:
    set_size(browser, size)
    left, right, start, end = browser.run("""(() => {
      const size = { column: 0, row: 0, width: 400, height: 100 };
      page.map.setGrid(1, { generation: 1, resolution: 0.05, x: -10, y: -5, yaw: 0, ...size });
      page.map.fit();
      const boxes = ["panels", "view"].map((id) => document.getElementById(id).getBoundingClientRect());
      return [boxes[0].right, boxes[1].left, page.map.view.toScreen(-10, 0)[0], page.map.view.toScreen(10, 0)[0]];
    })()""")
    assert left < start < end < right


@pytest.mark.parametrize("size", [*PHONES, *WIDE])
@pytest.mark.parametrize("name", ["places", "layers", "plots", "runs"])
def test_open_panel_leaves_stop_modes_and_first_line_in_reach_and_can_be_closed(
    robot: Robot, browser: Chromium, size: tuple[int, int], name: str
) -> None:
    robot.show(Kind.STATE, BUSY)
    set_size(browser, size)
    browser.run(f"page.panels.toggle('{name}'); 0")
    browser.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    reach = f"#stop, #modes button, .banner:first-child button, #{name}-panel .close"
    assert list_covered(browser, reach) == []
    assert browser.run(f"document.getElementById('{name}-panel').clientHeight") >= 90
    browser.run(f"document.querySelector('#{name}-panel .close').click(); 0")
    assert browser.run("page.panels.open") == ""


def test_a_finger_can_hit_what_is_shown_in_panels(robot: Robot, browser: Chromium) -> None:
    set_size(browser, PHONES[0])
    robot.show(Kind.STATE, BUSY)
    robot.show(Kind.PLACES, {"named": True, "places": {"desk": [0, 0, 0], "d": [1, 0, 0]}, "problem": ""})
    robot.show(Kind.ZONES, {"served": True, "zones": [], "problem": ""})
    for name in ("places", "zones", "layers", "plots", "speed"):
        browser.run(f"page.panels.toggle('{name}'); 0")
        assert browser.run(f"({SMALL})(44)") == [], name
        browser.run("page.panels.close(); 0")


def test_back_button_of_a_phone_closes_the_panel_and_leaves_the_page_open(browser: Chromium) -> None:
    if not browser.run("'CloseWatcher' in globalThis"):
        pytest.skip("this Chromium has no CloseWatcher")
    browser.run("page.panels.toggle('places'); page.panels.toggle('layers'); 0")
    browser.run("page.panels.back.requestClose(); 0")
    assert browser.run("[page.panels.open, document.activeElement.id, page.panels.back]") == ["", "layers", None]


def test_every_id_is_that_of_one_element(browser: Chromium) -> None:
    ids = browser.run("[...document.querySelectorAll('[id]')].map((e) => e.id)")
    assert sorted(ids) == sorted(set(ids))
