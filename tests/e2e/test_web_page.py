"""The page of `ur web` in a real browser, with the real simulator. One robot serves all tests of this file."""

import math
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest
from tests.chromium import Chromium
from tests.e2e.conftest import LaunchedRobot
from tests.e2e.web_page import PHONE, PROGRAM, BrowserPage, open_first, open_second, start_server

DESK = (1400, 900)

pytestmark = [
    pytest.mark.ros,
    pytest.mark.timeout(600),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
]
pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")


@pytest.fixture(scope="module")
def server(robot: LaunchedRobot) -> Iterator[tuple[int, Path]]:
    """`ur web`: its port, and the file of what it prints."""
    with start_server(robot.env, robot.log.parent) as server:
        yield server


@pytest.fixture(scope="module")
def browser(server: tuple[int, Path], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    with open_first(server, tmp_path_factory.mktemp("chromium")) as browser:
        yield browser


@pytest.fixture
def page(browser: Chromium) -> Iterator[BrowserPage]:
    page = BrowserPage(browser)
    page.wait("globalThis.page?.map.tiles.tiles.size && page.map.pose && page.state && page.drive.newest")
    browser.complaints.clear()
    yield page
    page.touch("End")
    assert browser.complaints == []


def test_link_leads_to_the_map_with_the_robot_on_it(page: BrowserPage) -> None:
    assert page.run("location.pathname + location.hash") == "/"
    assert page.run("document.title") == "simulated robot"
    page.wait("page.map.scan.length > 50 && !page.state.missing.length")
    assert abs(float(page.run("page.pose.x"))) < 0.3
    assert page.run("document.documentElement.scrollWidth") == PHONE[0]
    assert page.run("document.cookie") == ""  # no script sees the session


def test_stick_drives_while_it_is_held_and_stops_when_it_is_let_go(page: BrowserPage, robot: LaunchedRobot) -> None:
    before = robot.ask("where")["true"]
    page.tap("#mode-drive")
    page.push_stick()
    assert page.run("page.state.lease.client === page.drive.client")
    page.touch("End")
    after = robot.ask("still", seconds=150)["true"]
    assert abs(after[0] - before[0]) + abs(after[1] - before[1]) > 0.01
    assert page.run("page.drive.press") == "idle"


def test_hidden_page_lets_go(page: BrowserPage, robot: LaunchedRobot) -> None:
    page.tap("#mode-drive")
    page.push_stick()
    page.run("dispatchEvent(new Event('blur'))")
    assert page.run("page.drive.press") == "idle"
    robot.ask("still", seconds=150)
    page.touch("End")


def test_stop_button_stops_everything_until_the_release(page: BrowserPage, robot: LaunchedRobot) -> None:
    page.touch("Start", *page.middle("#stop"))  # a finger that stays
    robot.ask("stopped", value=True, seconds=150)
    page.touch("End")
    page.wait("document.querySelector('.banner.red button')")
    page.tap(".banner.red button")
    robot.ask("stopped", value=False, seconds=150)
    page.wait("!document.querySelector('.banner.red')")


def test_goal_is_set_by_press_drag_release_and_reached(page: BrowserPage) -> None:
    page.tap("#mode-goal")
    page.run("page.map.view.zoom(3, 195, 400); page.map.view.x = page.pose.x; page.map.view.y = page.pose.y; 0")
    x, y = page.run("page.map.view.toScreen(1.4, 0.0)")
    page.touch("Start", x, y)
    page.touch("Move", x, y - 60)
    page.touch("End")
    page.wait("page.state.goal.place")
    place = page.run("page.state.goal.place")
    heading = page.run("page.map.view.toYaw(Math.PI / 2)")  # a wide map is turned on a phone
    assert place == pytest.approx([1.4, 0.0, heading], abs=0.15)
    page.wait("page.state.goal.state === 'reached'", 120)
    page.run("page.map.fit()")


def test_place_is_named_on_the_page_and_driven_to(page: BrowserPage, robot: LaunchedRobot) -> None:
    page.tap_panel("places")
    page.wait("document.getElementById('place-here').checkVisibility()")
    page.run("document.getElementById('place-name').value = 'here'; document.getElementById('place-here').click(); 0")
    page.wait("page.map.places.here")
    here = page.run("[page.pose.x, page.pose.y]")
    assert page.run("page.map.places.here.slice(0, 2)") == pytest.approx(here, abs=0.2)
    page.run("page.sendPlace({t: 'name_place', place: 'door', x: 0.7, y: 0, yaw: 0}); 0")
    page.wait("document.querySelector('#places-panel .go')?.textContent === 'door'")
    (file,) = Path(robot.env["XDG_DATA_HOME"], "ubiquity_launches", "waypoints").glob("*.yaml")
    assert '"door": [0.700, 0.000, 0.0]' in file.read_text()
    page.tap("#places-panel .go")
    page.wait("page.state.goal.place?.[0] === 0.7 && page.state.goal.state === 'reached'", 120)
    assert abs(float(page.run("page.pose.x")) - 0.7) < 0.3
    page.tap_panel("places")
    for _ in range(2):  # the second press confirms
        page.tap("#places-panel li button:last-child")
    page.wait("!page.map.places.door")
    assert "door" not in file.read_text()
    page.tap_panel("places")


def test_patrol_goes_on_at_each_place_and_without_the_page_that_started_it(
    page: BrowserPage, robot: LaunchedRobot, server: tuple[int, Path], tmp_path: Path
) -> None:
    for name, x in (("sofa", 0.6), ("hall", 1.0)):
        page.run(f"page.sendPlace({{t: 'name_place', place: '{name}', x: {x}, y: 0, yaw: 0}}); 0")
    with open_second(page, server, tmp_path) as other:
        other.wait("page.map.places.sofa && page.map.places.hall && page.state.patrol")
        other.wait("page.state.lease.state === 'free'")  # the other page keeps it for 3 s after a goal
        other.tap_panel("places")
        other.wait("document.querySelectorAll('#places-panel .tick input').length >= 2")
        for name in ("sofa", "hall"):
            other.run(f"document.querySelector('#places-panel input[aria-label=\"Patrol: {name}\"]').click(); 0")
        other.run("document.getElementById('patrol-repeat').click(); document.getElementById('patrol').click(); 0")
        other.wait("page.state.patrol.state === 'driving'")
        other.browser.kill()
    robot.ask("patrol", state="driving", rounds=1, seconds=150)  # with no page that says anything else
    page.wait("document.getElementById('driver').textContent.startsWith('patrol drives')")
    page.press_banner("Pause")
    robot.ask("patrol", state="paused", seconds=150)
    robot.ask("still", seconds=150)
    page.press_banner("Continue")
    robot.ask("patrol", state="driving", seconds=150)
    page.press_banner("End the patrol")
    robot.ask("patrol", state="ended", seconds=150)
    robot.ask("still", seconds=150)
    page.wait("page.state.lease.state === 'free'")


def test_route_that_is_tapped_is_driven_and_shown(page: BrowserPage, robot: LaunchedRobot) -> None:
    wanted = [[1.0, 0.0], [0.5, 0.0]]
    page.run("page.map.show([0.7, 0, 60]); 0")
    page.tap_panel("route")
    page.wait("page.state.patrol && document.getElementById('route-tap').checkVisibility()")
    page.tap("#route-tap")
    for each in wanted:
        page.touch("Start", *page.run(f"page.map.view.toScreen(...{each})"))
        page.touch("End")
    page.wait("document.querySelector('#route-panel p').textContent.startsWith('Route of 2 points')")
    page.tap("#route-start")
    page.wait("page.state.patrol.state === 'driving' && document.getElementById('route-end').checkVisibility()")
    stops = page.run("page.state.patrol.stops")
    assert [each[1:] for each in stops] == [pytest.approx(each, abs=0.05) for each in wanted]
    robot.ask("patrol", state="done", seconds=150)
    page.wait("document.getElementById('route-tap').checkVisibility()")
    page.tap_panel("route")


def test_goal_that_is_tapped_asks_for_no_heading(page: BrowserPage) -> None:
    page.tap("#mode-goal")
    page.run("page.map.show([page.pose.x, page.pose.y, 60]); 0")
    x, y = page.run("page.map.view.toScreen(page.pose.x + 0.3, page.pose.y)")
    before = page.run("page.state.goal.number")  # that of the route, which asked for no heading either
    page.touch("Start", x, y)
    page.touch("End")
    page.wait(f"page.state.goal.number > {before} && page.state.goal.state === 'reached'", 120)
    assert page.run("page.state.goal.place[2]") is None
    page.run("page.map.fit(); 0")


def drive_to(page: BrowserPage, x: float, y: float) -> None:
    """Drive to a place of the map, wherever the tests before have left the robot."""
    before = page.run("page.state.goal.number")
    page.run(f"page.setMode('goal'); page.point({{x: {x}, y: {y}, yaw: 0}}); 0")
    page.wait(f"page.state.goal.number > {before} && page.state.goal.state === 'reached'", 120)


def test_zone_that_is_drawn_on_the_page_is_kept_out_of(page: BrowserPage, robot: LaunchedRobot) -> None:
    goal = 1.6  # m: in the corridor along the x axis, far from its ends
    drive_to(page, 0.6, 0.0)
    page.tap_panel("zones")
    page.wait("document.getElementById('zone-draw').checkVisibility()")
    page.tap("#zone-draw")
    # Above the panel, and so near that corners are farther apart than a fingertip.
    page.run("page.map.show([page.pose.x, page.pose.y, 60]); 0")
    here = page.run("[page.pose.x, page.pose.y]")
    for dx, dy in ((0.35, -0.4), (0.75, -0.4), (0.75, 0.4), (0.35, 0.4)):  # between the robot and the goal
        x, y = page.run(f"page.map.view.toScreen({here[0] + dx}, {here[1] + dy})")
        page.touch("Start", x, y)
        page.touch("End")
    page.wait("page.panels.panels.get('zones').box.querySelector('#zone-done').disabled === false")
    page.tap("#zone-done")
    page.wait("document.querySelector('#zones-panel li')?.textContent.startsWith('keep-out: keep out')")
    (file,) = Path(robot.env["XDG_DATA_HOME"], "ubiquity_launches", "zones").glob("*/keepout_mask.yaml")
    assert "mode: raw" in file.read_text()
    inside = [here[0] + 0.55, here[1]]
    page.tap_panel("zones")
    page.run(f"page.setMode('goal'); page.point({{x: {inside[0]}, y: {inside[1]}, yaw: 0}}); 0")
    page.wait("document.getElementById('banners').innerText.includes('in a keep-out zone')", 60)
    page.tap_panel("zones")
    for _ in range(2):  # the second press confirms
        page.tap("#zones-panel li button:last-child")
    page.wait("!document.querySelector('#zones-panel li')")
    assert not file.exists()
    page.tap_panel("zones")
    drive_to(page, goal, 0.0)
    page.wait("!document.getElementById('banners').innerText.includes('keep-out')")
    page.run("page.map.fit(); 0")


def test_layers_are_switched_and_a_link_shows_the_same(page: BrowserPage) -> None:
    page.run("document.getElementById('layers').click(); 0")
    for name in ("local", "global", "particles", "plan"):
        page.run(f"document.getElementById('layer-{name}').click(); 0")
    page.wait("page.map.costs.local.tiles.size && page.map.costs.global.tiles.size")
    page.wait("location.search.startsWith('?layers=scan,local,global,particles')")
    page.run("globalThis.page = null; location.reload(); 0")
    page.wait("globalThis.page?.map.costs.local.tiles.size && page.map.pose && page.state && page.drive.newest")
    assert page.run("[...page.map.layers].sort().join()") == "frontiers,global,local,particles,scan"
    page.run("document.getElementById('layer-local').click(); 0")
    page.run("history.replaceState(null, '', '/'); globalThis.page = null; location.reload(); 0")
    page.wait("globalThis.page?.map.tiles.tiles.size && page.map.pose && page.state && page.drive.newest")
    assert page.run("[...page.map.layers].sort().join()") == "frontiers,plan,scan"


def test_map_is_never_empty_while_its_size_changes(page: BrowserPage) -> None:
    corner = page.run(
        """new Promise((done) => {
          const { canvas, context } = page.map;
          let seen = 0;
          const observer = new ResizeObserver(() => {  // after the map's own, before the frame is shown
            seen += 1;
            if (seen === 1) canvas.style.width = "50%";
            else {
              observer.disconnect();
              canvas.style.width = "";
              done([...context.getImageData(5, canvas.height / 2, 1, 1).data]);
            }
          });
          observer.observe(canvas);
        })"""
    )
    assert max(corner[:3]) > 0


def test_page_recovers_when_the_end_at_the_robot_is_killed_while_the_stick_is_held(
    page: BrowserPage, robot: LaunchedRobot
) -> None:
    page.tap("#mode-drive")
    page.push_stick()
    (before,) = find_ends(robot)
    os.kill(before, signal.SIGKILL)
    robot.ask("still", seconds=150)
    page.wait("page.drive.press === 'dead'")
    page.wait("document.getElementById('banners').innerText.includes('Connecting to the robot')")
    page.wait("page.server.end === 'up' && page.poseAge < 0.3 && page.pose.linkAge < 0.3")
    assert find_ends(robot) != [before]
    assert page.run("page.drive.press") == "dead"  # until the stick is let go
    assert robot.ask("still", seconds=150)
    page.touch("End")
    page.push_stick()
    page.touch("End")
    robot.ask("still", seconds=150)


def press_until_refused(page: BrowserPage) -> None:
    """Press the stick until the press ends because another page drives, and not because this computer was late."""
    x, y = page.middle("#stick")
    for _ in range(5):
        page.touch("Start", x, y)
        page.touch("Move", x, y - 55)
        page.wait("page.drive.press === 'dead'")
        why = page.run("page.drive.why")
        page.touch("End")
        if why == "driver":
            return
        assert why == "late"
    raise AssertionError("late five times")


def find_ends(robot: LaunchedRobot) -> list[int]:
    """The processes at the robot's end of the page."""
    return [
        each.pid
        for each in psutil.process_iter(["cmdline", "environ"])
        if (each.info["environ"] or {}).get("ROS_MASTER_URI") == robot.env["ROS_MASTER_URI"]
        and "ur_nodes.web.robot_endpoint_node" in (each.info["cmdline"] or [])
    ]


def test_killed_browser_leaves_nothing_driving(
    page: BrowserPage, robot: LaunchedRobot, server: tuple[int, Path], tmp_path: Path
) -> None:
    page.run("page.drive.request({ t: 'lease', do: 'release' }); 0")
    with open_second(page, server, tmp_path) as other:
        other.tap("#mode-drive")
        other.push_stick()
        other.browser.kill()
    robot.ask("still", seconds=150)
    page.wait("page.poseAge < 0.3 && Math.abs(page.pose.speed) < 0.005")


DRIVES = "page.state.lease?.state === 'held' && page.state.lease.client === page.drive.client"


def take(page: BrowserPage) -> None:
    """Have a page drive, whoever does."""
    page.wait("page.state.lease")
    page.run("page.drive.request({ t: 'lease', do: 'take' }); 0")
    page.wait(DRIVES)


def test_second_page_asks_for_the_drive_is_given_it_and_it_is_taken_back(
    page: BrowserPage, robot: LaunchedRobot, server: tuple[int, Path], tmp_path: Path
) -> None:
    take(page)
    with open_second(page, server, tmp_path) as other:
        other.press_banner("Ask")
        other.wait("page.state.lease.asking.some((each) => each.client === page.drive.client)")
        other.tap("#mode-drive")
        press_until_refused(other)  # not before it is given
        assert page.run(DRIVES)
        page.press_banner("Hand over")
        other.wait(DRIVES)
        other.push_stick()
        page.press_banner("Take over")  # the other page holds its stick
        other.wait("page.drive.press === 'dead'")
        if other.run("page.drive.why") == "late":  # a busy computer had ended the press before
            other.touch("End")
            press_until_refused(other)
        assert other.run("page.drive.why") == "driver"
        robot.ask("still", seconds=150)
        page.wait(DRIVES)
        other.touch("End")
        other.wait("[...document.querySelectorAll('.banner button')].some((e) => e.textContent === 'Ask')")


def test_initial_pose_is_set_by_press_drag_release(page: BrowserPage, robot: LaunchedRobot) -> None:
    x, y, yaw = robot.ask("where")["true"]
    take(page)
    for aside in (0.3, 0.0):  # at last the truth, for the tests that follow
        page.tap("#mode-pose")
        page.run(f"page.map.show([{x}, {y}, 60]); 0")
        left, top = page.run(f"page.map.view.toScreen({x}, {y + aside})")
        page.touch("Start", left, top)
        page.touch("Move", left + 80 * math.cos(yaw), top - 80 * math.sin(yaw))
        page.touch("End")
        placed = robot.ask("placed", seconds=150)["pose"]
        assert placed[:2] == pytest.approx([x, y + aside], abs=0.05)
        assert math.cos(placed[2] - yaw) > 0.99
        assert page.run("page.mode") == "look"
    page.wait(f"Math.hypot(page.pose.x - {x}, page.pose.y - {y}) < 0.2 && Math.cos(page.pose.yaw - {yaw}) > 0.95")
    page.run("page.map.fit(); 0")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_controls_have_names_and_fit_on_phone_and_desk(page: BrowserPage, scheme: str, tmp_path: Path) -> None:
    browser = page.browser
    browser.prefer(scheme)
    page.wait("page.server.end === 'up' && page.poseAge < 0.3")
    for size in (DESK, PHONE):
        browser.resize(*size, phone=size == PHONE)
        page.tap("#mode-drive")
        (tmp_path / f"{scheme}-{size[0]}.png").write_bytes(browser.screenshot())
        hidden = page.run(
            "[...document.querySelectorAll('button, #stick')].filter((e) => e.checkVisibility())"
            ".filter((e) => { const box = e.getBoundingClientRect(); return box.left < 0 || box.top < 0 || "
            "box.right > innerWidth || box.bottom > innerHeight || "
            "!e.contains(document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2)); })"
            ".map((e) => e.id || e.textContent)"
        )
        assert hidden == []
    tree = browser.ask("Accessibility.getFullAXTree")["nodes"]
    nameless = [
        node["role"]["value"]
        for node in tree
        if node.get("role", {}).get("value") == "button" and not node.get("name", {}).get("value")
    ]
    assert nameless == []
