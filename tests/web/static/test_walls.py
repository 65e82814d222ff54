"""Walls of the map in a real browser: drawn, erased, taken back, sent in one request, and kept until that is done."""

from collections.abc import Iterator
from typing import Any

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import STATE, PlayedRobot, wait
from tests.web.static.test_layout import SMALL, list_covered, set_size
from tests.web.static.test_map_tools import drag

from ur.web.wire.frames import Kind
from ur.web.wire.map_requests import DrawWalls
from ur.web.wire.requests import read_request

pytestmark = MARKS
WALLS = {"name": "flat", "restorable": False, "why": ""}
NOTE = "page.walls.note.textContent"


def show_walls(robot: PlayedRobot, browser: Chromium, **change: Any) -> None:
    walls = WALLS | change
    robot.show(Kind.STATE, STATE | {"bumpers": [], "map": {"name": walls["name"], "saves": False, "walls": walls}})
    wait(lambda: browser.run("[page.walls.state.name, page.walls.state.restorable]") == list(walls.values())[:2])


def press(browser: Chromium, name: str) -> None:
    browser.run(f"document.getElementById('walls-{name}').click(); 0")


@pytest.fixture
def page(robot: PlayedRobot, browser: Chromium) -> Iterator[Chromium]:
    """The page with the panel of map tools; 100 pixels a metre round (2, 1)."""
    robot.asked.clear()
    set_size(browser, (1280, 800))
    browser.run("page.panels.show(['map_tools']); page.map.show([2, 1, 100]); 0")
    show_walls(robot, browser)
    yield browser
    browser.run("page.walls.strokes = []; page.walls.answered({ t: 'over' }); page.panels.show([]); 0")


def test_walls_are_drawn_erased_taken_back_and_saved_in_one_request(robot: PlayedRobot, page: Chromium) -> None:
    press(page, "begin")
    drag(page, (1.0, 0.5), (2.5, 0.5))
    drag(page, (1.0, 0.5), (1.0, 2.0))
    press(page, "undo")
    press(page, "erase")
    page.run("page.walls.width.value = '0.4'; 0")
    drag(page, (2.0, 1.5), (3.0, 1.5))
    assert "2 lines are not saved yet" in page.run(NOTE)
    assert robot.find("draw_walls") == []
    press(page, "save")
    wait(lambda: robot.find("draw_walls"))
    (asked,) = robot.find("draw_walls")
    assert asked["map"] == "flat"
    wall, erased = asked["strokes"]
    assert wall == [0, 0.1, *(pytest.approx(each, abs=0.02) for each in (1.0, 0.5, 2.5, 0.5))]
    assert [*erased[:2], *erased[-2:]] == [1, 0.4, *(pytest.approx(each, abs=0.02) for each in (3.0, 1.5))]
    assert page.run("page.walls.save.disabled"), "until there is an answer"
    page.run("page.take({ t: 'refused', what: 'draw_walls', why: 'the disk is full' }); 0")
    assert "disk is full" in page.run("document.getElementById('banners').innerText")
    assert "2 lines are not saved yet" in page.run(NOTE), "they can be saved again"
    press(page, "save")
    page.run("page.take({ t: 'done', what: 'draw_walls' }); 0")
    assert page.run(f"[{NOTE}, page.walls.strokes.length, page.walls.active]") == [
        "Saved. Navigation uses the new walls.",
        0,
        False,
    ]


def test_what_is_drawn_is_kept_when_a_goal_is_sent_meanwhile_and_dropped_by_cancel(
    robot: PlayedRobot, page: Chromium
) -> None:
    press(page, "begin")
    drag(page, (1.0, 0.5), (2.5, 0.5))
    page.run("page.setMode('goal'); 0")
    drag(page, (2.0, 1.0), (3.0, 1.0))
    wait(lambda: robot.find("goal"))
    assert page.run(NOTE) == "1 line is not saved yet. Press Walls to go on."
    press(page, "begin")
    press(page, "cancel")
    assert page.run("[page.walls.strokes.length, page.walls.active, page.walls.note.hidden]") == [0, False, True]
    drag(page, (1.0, 0.5), (2.5, 0.5))
    assert page.run("page.walls.strokes") == [], "a drag moves the map again"


def test_lines_of_one_map_are_not_saved_on_another_one(robot: PlayedRobot, page: Chromium) -> None:
    press(page, "begin")
    drag(page, (1.0, 0.5), (2.5, 0.5))
    show_walls(robot, page, name="", why="no server")
    assert page.run("page.walls.strokes.length") == 1, "the map server may start again"
    show_walls(robot, page, name="hall")
    wait(lambda: page.run("page.walls.strokes.length") == 0)
    assert "Another map is in use" in page.run("document.getElementById('banners').innerText")


REASONS = {"made": "is being made", "file": "is a file", "no server": "navigates"}


@pytest.mark.parametrize("why", REASONS)
def test_tool_says_why_a_map_cannot_be_changed(robot: PlayedRobot, page: Chromium, why: str) -> None:
    show_walls(robot, page, name="", why=why)
    wait(lambda: page.run("page.walls.state.why") == why)
    press(page, "begin")
    assert REASONS[why] in page.run(NOTE)
    assert not page.run("page.walls.active")


def test_two_fingers_move_the_map_and_draw_nothing(page: Chromium) -> None:
    press(page, "begin")
    before = page.run("page.map.view.x")
    page.ask("Emulation.setTouchEmulationEnabled", enabled=True)
    for kind, points in (
        ("touchStart", [(500, 300)]),
        ("touchStart", [(500, 300), (500, 500)]),
        ("touchMove", [(400, 300), (400, 500)]),
        ("touchEnd", []),
    ):
        touches = [{"x": x, "y": y, "id": index} for index, (x, y) in enumerate(points)]
        page.ask("Input.dispatchTouchEvent", type=kind, touchPoints=touches)
    page.ask("Emulation.setTouchEmulationEnabled", enabled=False)
    wait(lambda: page.run("page.map.view.x") > before + 0.5)
    assert page.run("[page.walls.strokes.length, page.walls.stroke]") == [0, None]


def test_line_is_typed_without_a_pointer(page: Chromium) -> None:
    press(page, "begin")
    page.run("""page.walls.line.box.open = true;
      page.walls.line.fields.forEach((field, index) => (field.value = ["1", "-0,5", "1", "2.25"][index]));
      page.walls.line.box.querySelector("button").click(); 0""")
    assert page.run("page.walls.strokes[0].points") == [[1, -0.5], [1, 2.25]]
    assert page.run("page.walls.line.fields.map((each) => each.value).join('')") == ""


def test_change_that_would_be_too_large_for_one_request_is_not_drawn(page: Chromium) -> None:
    press(page, "begin")
    page.run("""for (let y = 0; y < 300; y++) {
      page.walls.put({ erase: true, width: 0.1, points: [[-12.25, y], [-11.75, y + 0.5], [-10.25, y]] });
    }""")
    count, text = page.run("[page.walls.strokes.length, JSON.stringify(page.walls.pack(page.walls.strokes))]")
    assert 50 < count <= 100
    found = read_request(text)
    assert isinstance(found, DrawWalls)
    assert len(found.strokes) == count
    assert "Press Save" in page.run("document.getElementById('banners').innerText")


def test_map_before_is_restored_by_two_presses(robot: PlayedRobot, page: Chromium) -> None:
    assert not page.run("document.getElementById('walls-restore').checkVisibility()")
    show_walls(robot, page, restorable=True)
    press(page, "restore")
    assert robot.find("restore_walls") == []
    press(page, "restore")
    wait(lambda: robot.find("restore_walls") == [{"t": "restore_walls", "map": "flat"}])
    page.run("page.take({ t: 'done', what: 'restore_walls' }); 0")
    assert page.run(NOTE).startswith("Restored.")


@pytest.mark.parametrize("size", [(1280, 800), (390, 844), (360, 640), (844, 390), (720, 450)])
def test_tool_covers_no_control_and_fits_a_finger(robot: PlayedRobot, page: Chromium, size: tuple[int, int]) -> None:
    show_walls(robot, page, restorable=True)
    page.run("page.panels.show([]); 0")
    set_size(page, size)
    small = f"({SMALL})({40 if size[0] >= 1100 else 44})"
    others = set(page.run(small))  # low screens have low bars
    page.run("page.panels.show(['map_tools']); 0")
    reach = "#stop, #modes button, #view button, #map_tools-panel :is(button, select, summary)"
    for _ in range(2):
        page.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        assert list_covered(page, reach) == []
        assert not set(page.run(small)) - others
        press(page, "begin")
        page.run("page.walls.put({ erase: false, width: 0.1, points: [[1, 1], [2, 1]] }); 0")
