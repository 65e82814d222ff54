"""Tools of the map in a real browser: places that are named, moved and renamed, and distances that are measured."""

from collections.abc import Iterator
from typing import Any

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import STATE, PlayedRobot, wait

from ur.web.wire.frames import Kind

pytestmark = MARKS
PLACES = {"desk": [0, 0, 0], "door": [1, 0, 0.5]}


@pytest.fixture
def page(robot: PlayedRobot, browser: Chromium) -> Iterator[Chromium]:
    """The page with two places; 100 pixels a metre round (2, 1)."""
    robot.asked.clear()
    robot.show(Kind.STATE, STATE | {"bumpers": []})
    robot.show(Kind.PLACES, {"named": True, "places": PLACES, "problem": ""})
    browser.resize(1200, 800)
    wait(lambda: browser.run("Object.keys(page.map.places).join()") == "desk,door")
    settle(browser)
    browser.run("page.map.show([2, 1, 100]); 0")
    yield browser
    browser.run("page.panels.show([]); page.setMode('look'); 0")


def settle(page: Chromium) -> None:
    """Wait until the map has the size that panels which were opened or closed leave to it."""
    page.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def drag(page: Chromium, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Press the mouse at a point of the map (m), and let go at another one."""
    settle(page)
    first, last = page.run(f"[{list(start)}, {list(end)}].map((point) => page.map.view.toScreen(...point))")
    for kind, (x, y) in (("mousePressed", first), ("mouseMoved", last), ("mouseReleased", last)):
        page.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)


def test_place_is_named_where_the_map_is_pressed_and_may_have_a_blank(robot: PlayedRobot, page: Chromium) -> None:
    page.run("page.panels.show(['places']); document.getElementById('place-name').value = 'living room'; 0")
    page.run("document.getElementById('place-on-map').click(); 0")
    assert "living room" in page.run("document.getElementById('hint').textContent")
    drag(page, (2.5, 1.5), (2.5, 2.5))
    wait(lambda: robot.find("name_place"))
    (asked,) = robot.find("name_place")
    assert asked["place"] == "living room"
    assert [asked["x"], asked["y"], asked["yaw"]] == pytest.approx([2.5, 1.5, 1.5708], abs=0.02)
    drag(page, (2.0, 1.0), (2.2, 1.0))
    assert len(robot.find("name_place")) == 1, "the next drag moves the map"
    assert robot.find("goal") == []


def test_place_is_renamed_and_the_old_name_goes_only_when_the_new_one_is_there(
    robot: PlayedRobot, page: Chromium
) -> None:
    page.run("page.panels.show(['places']); 0")
    page.run("document.querySelector('[aria-label=\"Edit the place door\"]').click(); 0")
    assert page.run("document.activeElement.ariaLabel") == "New name of door"
    for name, line in (("desk", "Not renamed: there is a place desk."), ("<i>", "Not named: ")):
        page.run(f"document.activeElement.value = '{name}'; 0")
        page.press("Enter")
        assert line in page.run("document.getElementById('banners').innerText")
    page.run("document.activeElement.value = 'front door'; 0")
    page.press("Enter")
    wait(lambda: robot.find("name_place"))
    (asked,) = robot.find("name_place")
    assert [asked[each] for each in ("place", "x", "y", "yaw")] == ["front door", 1, 0, 0.5]
    robot.show(Kind.PLACES, {"named": True, "places": PLACES | {"other": [3, 3, 0]}, "problem": ""})
    wait(lambda: page.holds("page.map.places.other"))
    assert robot.find("forget_place") == []
    robot.show(Kind.PLACES, {"named": True, "places": PLACES | {"front door": [1, 0, 0.5]}, "problem": ""})
    wait(lambda: robot.find("forget_place"))
    assert [each["place"] for each in robot.find("forget_place")] == ["door"]


def test_place_is_moved_to_a_point_of_the_map(robot: PlayedRobot, page: Chromium) -> None:
    page.run("page.panels.show(['places']); 0")
    page.run("document.querySelector('[aria-label=\"Edit the place desk\"]').click(); 0")
    page.run("document.querySelector('#places-panel .edited .row button').click(); 0")
    drag(page, (3.0, 0.5), (4.0, 0.5))
    wait(lambda: robot.find("name_place"))
    (asked,) = robot.find("name_place")
    assert [asked["place"], asked["x"], asked["y"], asked["yaw"]] == ["desk", *map(pytest.approx, (3.0, 0.5, 0.0))]


def test_distance_is_measured_along_the_points_that_are_tapped(page: Chromium) -> None:
    page.run("page.panels.show(['map_tools']); document.getElementById('measure').click(); 0")
    for point in ((1.0, 0.0), (1.0, 1.5), (3.0, 1.5)):
        drag(page, point, point)
    assert page.run("document.querySelector('#map_tools-panel p').textContent") == "Length of the line: 3.50 m."
    page.run("document.querySelectorAll('#map_tools-panel .row button')[2].click(); 0")
    page.run("page.panels.toggle('zones'); document.getElementById('zone-draw').click(); 0")
    assert page.run("page.panels.panels.get('map_tools').box.innerText.includes('Measure a distance')")
    drag(page, (1.0, 1.0), (1.0, 1.0))
    wait(lambda: page.run("page.panels.panels.get('zones').box.innerText").count("Tap the corners") == 1)


BEGIN = {"map_tools": "measure", "zones": "zone-draw", "route": "route-tap"}


@pytest.mark.parametrize("panel", BEGIN)
def test_tool_that_takes_taps_ends_when_a_press_gets_another_meaning(
    robot: PlayedRobot, page: Chromium, panel: str
) -> None:
    robot.show(Kind.STATE, STATE | {"bumpers": [], "patrol": PATROL})
    robot.show(Kind.ZONES, {"served": True, "zones": [], "problem": ""})
    wait(lambda: page.holds("page.state.patrol"))
    begin = f"page.panels.show(['places', '{panel}']); document.getElementById('{BEGIN[panel]}').click(); 0"
    low = f"document.getElementById('{panel}-panel').classList.contains('low')"
    place = "document.getElementById('place-name').value = 'hall'; document.getElementById('place-on-map').click(); 0"
    for press, kind in (
        (place, "name_place"),
        ("page.setMode('pose'); 0", "pose"),
        ("page.setMode('goal'); 0", "goal"),
    ):
        page.run(begin)
        assert page.run(low)
        page.run(press)
        assert not page.run(low)
        drag(page, (2.0, 1.0), (3.0, 1.0))
        wait(lambda kind=kind: robot.find(kind))
    page.run(begin)
    page.run("page.setMode('drive'); 0")
    assert page.run(low), "driving leaves the taps to the tool"


PATROL: dict[str, Any] = {"state": "idle", "line": "", "stops": [], "index": 0, "loop": False}


def test_route_that_is_tapped_is_sent_and_its_patrol_is_shown_until_it_ends(robot: PlayedRobot, page: Chromium) -> None:
    robot.show(Kind.STATE, STATE | {"bumpers": [], "patrol": PATROL})
    wait(lambda: page.holds("page.state.patrol"))
    page.run("page.panels.show(['route']); document.getElementById('route-tap').click(); 0")
    start = "document.getElementById('route-start').disabled"
    assert page.run(start)
    for point in ((1.0, 1.0), (0.5, 2.5), (2.0, 1.5), (3.0, 1.5)):
        drag(page, point, point)
    page.run("document.getElementById('route-undo').click(); document.getElementById('route-repeat').click(); 0")
    assert not page.run(start)
    page.run("document.getElementById('route-start').click(); 0")
    wait(lambda: robot.find("patrol"))
    (asked,) = robot.find("patrol")
    assert [asked["do"], asked["loop"]] == ["start", True]
    assert asked["places"] == [pytest.approx(each, abs=0.02) for each in ([1.0, 1.0], [0.5, 2.5], [2.0, 1.5])]
    line = "document.querySelector('#route-panel p').textContent"
    assert page.run(line).startswith("Route of 3 points."), "the request may be refused"
    stops = [["", *each] for each in asked["places"]]
    driving = PATROL | {"state": "driving", "line": "patrol: drives to (1.00, 1.00) (1 of 3)", "stops": stops}
    robot.show(Kind.STATE, STATE | {"bumpers": [], "patrol": driving})
    wait(lambda: page.run(line) == "Patrol: drives to (1.00, 1.00) (1 of 3)")
    goal, seen = page.run(f"[page.map.colours.goal, {COLOUR_AT}(0.93, 1.0)]")
    assert seen == goal, "the point that the robot drives to"
    drag(page, (2.5, 0.5), (2.5, 0.5))
    assert page.run(line).startswith("Patrol: "), "taps are taken no more"
    page.run("document.getElementById('route-end').click(); 0")
    wait(lambda: [each["do"] for each in robot.find("patrol")] == ["start", "end"])
    robot.show(Kind.STATE, STATE | {"bumpers": [], "patrol": PATROL | {"state": "ended", "stops": stops}})
    wait(lambda: page.run(line).startswith("Tap points of the map"))
    assert page.run(f"{COLOUR_AT}(0.93, 1.0)") != goal


# The colour of the map at a point (m), as "#rrggbb", after it was drawn.
COLOUR_AT = """((x, y) => {
  page.map.draw();
  const [left, top] = page.map.view.toScreen(x, y).map((each) => Math.round(each * page.map.ratio));
  const copy = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
  copy.drawImage(page.map.canvas, left, top, 1, 1, 0, 0, 1, 1);
  const bytes = copy.getImageData(0, 0, 1, 1).data.slice(0, 3);
  return "#" + [...bytes].map((each) => each.toString(16).padStart(2, "0")).join("");
})"""


def test_coordinates_of_what_is_pointed_at_and_the_scale_are_shown(page: Chromium) -> None:
    x, y = page.run("page.map.view.toScreen(2.5, 0.25)")
    page.ask("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    wait(lambda: page.run("document.querySelector('#scale .number').textContent") == "x 2.50  y 0.25 m")
    wait(lambda: page.run("document.querySelector('#scale .length').textContent") == "1 m")
    assert page.run("document.querySelector('#scale .length').offsetWidth") == 100
