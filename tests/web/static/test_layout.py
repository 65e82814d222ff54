"""The parts of the page on every size of screen: nothing covers a control, and fingers can hit each of them."""

from typing import Any

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import STATE, PlayedRobot, wait

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
    robot: PlayedRobot, browser: Chromium, size: tuple[int, int]
) -> None:
    robot.show(Kind.STATE, BUSY)
    wait(lambda: browser.run("document.querySelectorAll('.banner').length") == 2)
    set_size(browser, size)
    for mode in ("look", "goal", "drive", "pose"):
        browser.run(f"page.setMode('{mode}'); 0")
        assert list_covered(browser, "body > button, body > nav button, #stick, #goal button, .banner button") == []
    browser.run("page.setMode('look'); 0")


DESKS = [(1280, 800), (1440, 900), (1024, 640)]
SHORT = [(640, 360), (844, 390)]  # their menu scrolls
TALL = [size for size in PHONES if size[0] < size[1]]
SHOW_WIDE_MAP = """(() => {
      const size = { column: 0, row: 0, width: 400, height: 300 };
      page.map.setGrid(1, { generation: 1, resolution: 0.05, x: -10, y: -5, yaw: 0, ...size });
      page.map.fit();
      const bounds = page.map.tiles.bounds();
      const corners = [[bounds[0], bounds[1]], [bounds[2], bounds[3]]].map((each) => page.map.view.toScreen(...each));
      return [Math.abs(corners[0][0] - corners[1][0]), Math.abs(corners[0][1] - corners[1][1])];
    })()"""


@pytest.mark.parametrize("size", PHONES)
def test_controls_lie_over_the_map_on_a_phone(browser: Chromium, size: tuple[int, int]) -> None:
    set_size(browser, size)
    assert browser.run("[page.map.canvas.clientWidth, page.map.canvas.clientHeight]") == list(size)


@pytest.mark.parametrize("size", TALL)
def test_map_takes_nine_tenths_of_the_width_of_a_phone(browser: Chromium, size: tuple[int, int]) -> None:
    set_size(browser, size)
    width, height = browser.run(SHOW_WIDE_MAP)
    assert 0.9 * size[0] <= width <= size[0]
    assert height > 1.2 * width, "a wide map is turned"


@pytest.mark.parametrize("size", PHONES)
def test_menu_of_a_phone_opens_a_panel_and_leaves_the_stop_in_reach(browser: Chromium, size: tuple[int, int]) -> None:
    set_size(browser, size)
    assert not browser.run("document.getElementById('panels').checkVisibility()")
    browser.run("document.getElementById('menu').click(); 0")
    assert browser.run("[document.activeElement.textContent, document.getElementById('menu').ariaExpanded]") == [
        "Drive",
        "true",
    ]
    assert list_covered(browser, "#stop, #menu, #modes button") == []
    browser.run("page.panels.reveal('places'); document.querySelector('details:has(#layers) > summary').click(); 0")
    words = (
        "[...document.querySelectorAll('#panels summary, #panels [open] button')].map((each) => each.innerText.trim())"
    )
    assert len(browser.run(f"{words}.filter(Boolean)")) == 5 + 4
    assert list_covered(browser, "#panels summary, #layers") == [] or size in SHORT
    browser.run("document.getElementById('layers').click(); 0")
    assert browser.run("[page.panels.shown, document.activeElement.id]") == [["layers"], "layers-panel"]
    assert not browser.run("document.getElementById('panels').checkVisibility()")
    browser.press("Escape")
    assert browser.run("[page.panels.shown, document.activeElement.id]") == [[], "menu"]


@pytest.mark.parametrize("size", DESKS)
def test_panels_stand_beside_the_map_of_a_desk_and_cover_nothing(
    robot: PlayedRobot, browser: Chromium, size: tuple[int, int]
) -> None:
    robot.show(Kind.STATE, BUSY)
    set_size(browser, size)
    browser.run("page.setMode('drive'); page.panels.show(['places', 'plots']); 0")
    assert browser.run("page.panels.shown") == ["places", "plots"]
    beside = "body > button, body > nav button, #stick, #goal button, .panel .close, .banner button"
    assert list_covered(browser, beside) == []
    boxes = browser.run("""[...document.querySelectorAll("#map, .panel:not([hidden])")]
      .map((each) => each.getBoundingClientRect())
      .map((box) => [box.left, box.top, box.right, box.bottom])""")
    for index, (left, top, right, bottom) in enumerate(boxes):
        for other in boxes[index + 1 :]:
            assert right <= other[0] or other[2] <= left or bottom <= other[1] or other[3] <= top
    assert boxes[0][2] - boxes[0][0] >= 360
    browser.run("page.setMode('look'); page.panels.show([]); 0")


@pytest.mark.parametrize("size", [(1280, 800), (1133, 744), (1024, 640)])
def test_buttons_of_all_panels_are_in_reach_on_a_tablet(browser: Chromium, size: tuple[int, int]) -> None:
    set_size(browser, size)
    browser.ask("Emulation.setTouchEmulationEnabled", enabled=True)
    for index in range(browser.run("document.querySelectorAll('#panels details').length")):
        browser.run(f"document.querySelectorAll('#panels details')[{index}].open = true; 0")
        browser.run("document.getElementById('panels').lastElementChild.scrollIntoView(); 0")
        assert list_covered(browser, "#panels details:last-child > summary, #stop, #modes button") == []
        browser.run("document.querySelector('#panels [open] button:last-child').scrollIntoView(); 0")
        assert list_covered(browser, "#panels [open] button:last-child, #stop, #modes button") == []
    browser.ask("Emulation.setTouchEmulationEnabled", enabled=False)


@pytest.mark.parametrize("size", [(1366, 650), (1280, 800), (1440, 900)])
def test_list_of_panels_needs_no_scrolling_on_a_desk_and_cuts_no_word(browser: Chromium, size: tuple[int, int]) -> None:
    set_size(browser, size)
    for name in ("places", "maps", "camera", "programs", "status"):
        browser.run(f"page.panels.reveal('{name}'); 0")
        bar = browser.run("(({ clientHeight, scrollHeight }) => [clientHeight, scrollHeight])(page.panels.bar)")
        assert bar[0] == bar[1]
        cut = "[...page.panels.bar.querySelectorAll('span')].filter((e) => e.scrollWidth > e.clientWidth)"
        assert browser.run(f"{cut}.map((e) => e.textContent)") == []


HEIGHTS = """page.panels.shown.map((name) => page.panels.panels.get(name).box)
  .map((box) => [box.clientHeight, box.scrollHeight])"""


@pytest.mark.parametrize("size", [(1366, 650), (1280, 800)])
def test_panel_that_was_just_opened_gets_the_room_that_it_needs_and_older_ones_shrink_to_their_title(
    robot: PlayedRobot, browser: Chromium, size: tuple[int, int]
) -> None:
    names = {f"place {number}": [number, 0, 0] for number in range(30)}
    robot.show(Kind.PLACES, {"named": True, "places": names, "problem": ""})
    set_size(browser, size)
    browser.run("page.panels.show([]); page.panels.choose('places'); 0")
    wait(lambda: browser.run("document.querySelectorAll('#places-panel li').length") == 30)
    title = browser.run("document.querySelector('#places-panel .head').offsetHeight")
    for name in ("speed", "layers"):
        browser.run(f"page.panels.choose('{name}'); 0")
        *older, (height, needed) = browser.run(HEIGHTS)
        assert height == needed or max(older)[0] <= title + 2, name
    browser.run("page.panels.show(['layers', 'places']); 0")  # the newest could fill the page
    (old, _), (new, needed) = browser.run(HEIGHTS)
    assert title <= old <= title + 2 < 100 < new < needed
    assert list_covered(browser, ".panel .close, .panel h2") == []
    browser.run("page.panels.choose('layers'); 0")  # seen no more than its title: it is the newest again
    assert browser.run("page.panels.shown") == ["places", "layers"]
    (old, _), (height, needed) = browser.run(HEIGHTS)
    assert height == needed or old <= title + 2
    browser.run("document.querySelector('#places-panel h2 button').click(); 0")
    assert browser.run("page.panels.shown") == ["layers", "places"]
    browser.run("page.panels.show([]); 0")


@pytest.mark.parametrize("size", [*PHONES, *DESKS, (820, 1180)])
def test_nothing_covers_the_scale_of_the_map(robot: PlayedRobot, browser: Chromium, size: tuple[int, int]) -> None:
    robot.show(Kind.STATE, BUSY)
    set_size(browser, size)
    browser.run("page.map.fit(); document.getElementById('scale').style.pointerEvents = 'auto'; 0")
    for mode in ("look", "goal", "drive", "pose"):
        for name in ("", "places", "layers", "plots", "runs"):
            browser.run(f"page.setMode('{mode}'); page.panels.show(['{name}']); 0")
            assert list_covered(browser, "#scale .length") == [], (mode, name)
        browser.run("page.panels.show([]); page.panels.openMenu(true); 0")
        assert list_covered(browser, "#scale .length") == [], (mode, "menu")
        browser.run("page.panels.openMenu(false); 0")
    browser.run("page.setMode('look'); document.getElementById('scale').style.pointerEvents = ''; 0")


def test_open_panels_and_their_width_are_in_the_address(browser: Chromium) -> None:
    set_size(browser, (1280, 800))
    browser.run("page.panels.show(['layers', 'speed']); document.getElementById('dock-width').focus(); 0")
    before = browser.run("document.getElementById('dock').offsetWidth")
    browser.press("ArrowLeft")
    assert browser.run("document.getElementById('dock').offsetWidth") == before + 32
    wait(lambda: browser.run("location.search") == f"?panels=layers,speed&dock={before + 32}")
    browser.run("globalThis.page = null; location.reload(); 0")
    wait(lambda: browser.holds("globalThis.page?.panels?.shown.join() === 'layers,speed'"))
    assert browser.run("document.getElementById('dock').offsetWidth") == before + 32
    set_size(browser, PHONES[0])
    assert browser.run("page.panels.shown") == ["speed"]
    browser.run("page.panels.show([]); page.panels.dock.width = 0; 0")
    wait(lambda: browser.holds("page.state && page.drive.newest && location.search === ''"))


@pytest.mark.parametrize("size", [(1440, 900), (720, 450)])
def test_whole_map_is_shown_between_the_bars(browser: Chromium, size: tuple[int, int]) -> None:
    set_size(browser, size)
    left, right, start, end = browser.run("""(() => {
      const size = { column: 0, row: 0, width: 400, height: 100 };
      page.map.setGrid(1, { generation: 1, resolution: 0.05, x: -10, y: -5, yaw: 0, ...size });
      page.map.fit();
      const boxes = ["panels", "view"].map((id) => document.getElementById(id).getBoundingClientRect());
      const end = innerWidth < 900 ? innerWidth : boxes[1].left;
      return [boxes[0].right, end, page.map.view.toScreen(-10, 0)[0], page.map.view.toScreen(10, 0)[0]];
    })()""")
    assert left < start < end < right


@pytest.mark.parametrize("size", [*PHONES, *WIDE])
@pytest.mark.parametrize("name", ["places", "layers", "plots", "runs"])
def test_open_panel_leaves_stop_modes_and_first_line_in_reach_and_can_be_closed(
    robot: PlayedRobot, browser: Chromium, size: tuple[int, int], name: str
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


def test_a_finger_can_hit_what_is_shown_in_panels(robot: PlayedRobot, browser: Chromium) -> None:
    set_size(browser, PHONES[0])
    robot.show(Kind.STATE, BUSY)
    robot.show(Kind.PLACES, {"named": True, "places": {"desk": [0, 0, 0], "d": [1, 0, 0]}, "problem": ""})
    robot.show(Kind.ZONES, {"served": True, "zones": [], "problem": ""})
    for name in ("places", "route", "map_tools", "maps", "zones", "layers", "plots", "speed"):
        browser.run(f"page.panels.toggle('{name}'); 0")
        assert browser.run(f"({SMALL})(44)") == [], name
        browser.run("page.panels.close(); 0")


def test_back_button_of_a_phone_closes_the_panel_and_leaves_the_page_open(browser: Chromium) -> None:
    if not browser.run("'CloseWatcher' in globalThis"):
        pytest.skip("this Chromium has no CloseWatcher")
    browser.run("page.panels.toggle('places'); page.panels.toggle('layers'); 0")
    browser.run("page.panels.back.requestClose(); 0")
    opener = "(document.getElementById('layers').checkVisibility() ? 'layers' : 'menu')"
    assert browser.run(f"[page.panels.open, document.activeElement.id === {opener}, page.panels.back]") == [
        "",
        True,
        None,
    ]


def test_every_id_is_that_of_one_element(browser: Chromium) -> None:
    ids = browser.run("[...document.querySelectorAll('[id]')].map((e) => e.id)")
    assert sorted(ids) == sorted(set(ids))
