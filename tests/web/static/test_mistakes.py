"""What users get wrong on the page: it says so, and what they have typed or drawn stays."""

from collections.abc import Iterator

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import STATE, PlayedRobot, wait

from ur.web.wire.frames import Kind

pytestmark = MARKS
GOAL = {"number": 0, "place": [1.0, 0.0, 0.0], "state": "none", "text": "", "left": None}
SQUARE = [[0, 0], [1, 0], [1, 1]]


@pytest.fixture
def page(robot: PlayedRobot, browser: Chromium) -> Iterator[Chromium]:
    """The page with a place and a zone."""
    robot.asked.clear()
    robot.show(Kind.STATE, STATE | {"bumpers": [], "goal": GOAL})
    robot.show(Kind.PLACES, {"named": True, "places": {"desk": [0, 0, 0]}, "problem": ""})
    zones = [{"name": "stairs", "percent": 0, "corners": SQUARE}]
    robot.show(Kind.ZONES, {"served": True, "zones": zones, "problem": ""})
    wait(lambda: browser.run("document.querySelectorAll('#zones-panel li, #places-panel li').length") == 2)
    yield browser
    browser.run("page.panels.close(); 0")


def name_place(page: Chromium, name: str) -> None:
    page.run(f"document.getElementById('place-name').value = {name!r}; 0")
    page.run("document.getElementById('place-here').click(); 0")


def lines(page: Chromium) -> str:
    text: str = page.run("document.getElementById('banners').innerText")
    return text


@pytest.mark.parametrize("name", ["two\tparts", "<b>bold</b>", 'it"s', "-first", "a" * 41, ""])
def test_bad_name_of_a_place_stays_in_its_field_and_is_not_sent(robot: PlayedRobot, page: Chromium, name: str) -> None:
    page.run("page.panels.toggle('places'); 0")
    name_place(page, name)
    assert lines(page).startswith("Not named: ")
    assert page.run("document.getElementById('place-name').value") == name
    assert robot.find("name_place") == []
    assert page.run("document.querySelector('#banners b')") is None


def test_place_is_moved_only_when_its_name_is_given_twice(robot: PlayedRobot, page: Chromium) -> None:
    page.run("page.panels.toggle('places'); 0")
    name_place(page, "desk")
    assert "There is a place desk. Press again to move it to the robot." in lines(page)
    assert robot.find("name_place") == []
    page.run("document.getElementById('place-here').click(); 0")
    wait(lambda: robot.find("name_place"))
    name_place(page, "\u00fcber")
    wait(lambda: len(robot.find("name_place")) == 2)
    assert page.run("document.getElementById('place-name').value") == ""


def test_zone_keeps_its_corners_when_its_name_is_bad_or_taken(robot: PlayedRobot, page: Chromium) -> None:
    page.run("page.panels.toggle('zones'); document.getElementById('zone-draw').click(); 0")
    for x, y in SQUARE:
        page.run(f"page.gestures.onTap({x}, {y}); 0")
    for name, line in (("<i>", "Not named: "), ("stairs", "There is a zone stairs. Press Done again to replace it.")):
        page.run(f"document.getElementById('zone-name').value = {name!r}; 0")
        page.run("document.getElementById('zone-done').click(); 0")
        assert line in lines(page)
        assert robot.find("put_zone") == []
        assert page.run("document.getElementById('zone-done').disabled") is False
    page.run("document.getElementById('zone-done').click(); 0")
    wait(lambda: robot.find("put_zone"))
    assert robot.find("put_zone")[0]["corners"] == [0, 0, 1, 0, 1, 1]


def test_rectangle_of_a_zone_is_typed_by_keys_alone(robot: PlayedRobot, page: Chromium) -> None:
    page.run("page.panels.toggle('zones'); document.getElementById('zone-draw').focus(); 0")
    page.press("Enter")
    page.run("document.querySelector('#zones-panel .rectangle summary').focus(); 0")
    page.press("Enter")
    wait(
        lambda: (
            page.run("document.querySelector('#zones-panel .rectangle p').textContent")
            == "The robot is at x 0.00, y 0.00 m."
        )
    )
    for text in ("1.5", "-0,5", "far", "2"):
        page.press("Tab")
        page.write(text)
    assert page.run("document.getElementById('zone-done').disabled")
    assert page.run("[...document.querySelectorAll('#zones-panel .rectangle input')].map((e) => e.ariaInvalid)") == [
        "false", "false", "true", "false",
    ]  # fmt: skip
    page.run("document.querySelectorAll('#zones-panel .rectangle input')[2].select(); 0")
    page.write("1")
    assert page.run("document.getElementById('zone-done').disabled") is False
    page.press("Enter")
    wait(lambda: robot.find("put_zone"))
    zone = {"t": "put_zone", "zone": "keep-out", "percent": 0, "corners": [1.5, 1, -0.5, 1, -0.5, 2, 1.5, 2]}
    assert robot.find("put_zone") == [zone]


def test_goal_that_is_refused_at_once_is_said_to_be(robot: PlayedRobot, page: Chromium) -> None:
    text = "emergency stop is on; release it first"
    robot.show(Kind.STATE, STATE | {"bumpers": [], "goal": GOAL | {"number": 1, "state": "failed", "text": text}})
    wait(lambda: f"Goal not reached: {text}" in lines(page))


def test_stop_that_does_not_arrive_is_said_in_red_until_the_robot_has_stopped(
    robot: PlayedRobot, page: Chromium
) -> None:
    page.run("globalThis.real = fetch; globalThis.fetch = () => Promise.reject(new Error()); page.stop(); 0")
    wait(lambda: page.holds("document.querySelector('.banner.red')?.textContent.startsWith('NOT STOPPED')"))
    robot.show(Kind.STATE, STATE | {"mux": STATE["mux"] | {"stopped": True}})
    wait(lambda: "Emergency stop: nothing drives." in lines(page))
    assert "NOT STOPPED" not in lines(page)
    page.run("globalThis.fetch = real; 0")


def test_goal_without_a_robot_is_not_blamed_on_a_slow_connection(robot: PlayedRobot, page: Chromium) -> None:
    page.run("page.drive.stopped = page.drive.request; page.drive.request = () => false; 0")
    for end, line in (("no master", "Not sent: the robot is not connected."), ("up", "the connection was too slow")):
        page.run(f"page.server = {{ ...page.server, end: '{end}' }}; page.point({{ x: 1, y: 0, yaw: 0 }}); 0")
        assert line in lines(page)
    page.run("page.drive.request = page.drive.stopped; 0")
    assert robot.find("goal") == []


def test_copy_of_a_tab_is_another_client_and_both_stay_connected(page: Chromium) -> None:
    page.run("page.drive.newest = null; globalThis.before = page.drive.client; 0")
    page.run("globalThis.copy = new WebSocket(`ws://${location.host}/ws/drive?tab=${page.drive.tab}`); 0")
    wait(lambda: page.run("page.drive.client !== before && page.drive.newest !== null"))
    wait(lambda: page.run("copy.readyState") == 1)
    assert page.run("sessionStorage.tab === page.drive.tab")
    page.run("copy.close(); 0")


def test_log_shows_the_time_of_day_in_place_of_seconds_since_1970(page: Chromium) -> None:
    page.run("page.panels.toggle('runs'); 0")
    lines = page.run("""(async () => {
      const { RunLog } = await import("/run_log.js"), log = new RunLog(document.createElement("div"));
      const texts = ["[ERROR] [1795405662.385888]: a", "[ INFO] [1795405662.385888123, 12.3]: b", "[WARN] [1.0]: c"];
      log.take({ run: "", first: 0, lines: texts.map((text) => ["/n", "error", text]) });
      return [[...log.list.children].map((e) => e.textContent), new Date(1795405662000).toLocaleTimeString()];
    })()""")
    assert lines == [[f"n [ERROR] {lines[1]} a", f"n [ INFO] {lines[1]} b", "n [WARN] [1.0]: c"], lines[1]]


def test_new_link_that_is_opened_in_the_tab_of_an_old_one_logs_in(robot: PlayedRobot, page: Chromium) -> None:
    page.ask("Network.enable")
    page.ask("Network.clearBrowserCookies")
    page.open(f"http://127.0.0.1:{robot.port}/login")
    wait(lambda: "another one" in page.run("document.body.innerText"))
    page.run(f"location.hash = {robot.link.partition('#')[2]!r}; 0")
    wait(lambda: page.holds("globalThis.page?.state"))


def test_slow_connection_is_said_with_its_delay_and_a_way_out(page: Chromium) -> None:
    page.run("""globalThis.real = fetch;
      globalThis.fetch = (...all) => new Promise((done) => setTimeout(done, 400)).then(() => real(...all));
      page.setMode("drive"); page.drive.move(0.1, 0); page.drive.end("late"); 0""")
    wait(lambda: "driving by hand needs less than 150. Send goals, or go nearer." in lines(page))
    page.run("page.drive.letGo(); globalThis.fetch = real; page.drive.move(0.1, 0); page.drive.end('late'); 0")
    wait(lambda: "The connection paused" in lines(page))
    page.run("page.drive.letGo(); page.setMode('look'); 0")


def test_run_in_the_way_is_ended_by_a_button_and_the_program_started(page: Chromium) -> None:
    found = page.run("""(async () => {
      const { RUNS } = await import("/run_socket.js"), asked = [];
      const run = { run: "m_navigate.1", title: "navigate", started: 1, stopping: null, lost: null, nodes: [] };
      const programs = ["raspicam", "rviz_robot", "keyboard_navigate", "make_map"].map((name) =>
        ({ name, summary: "s", lack: "", problem: "", file: false, arguments: [] }));
      const real = fetch, { request, use } = RUNS;
      RUNS.use = () => {}; // no state of the server takes the place of this one
      const list = JSON.stringify(programs);
      globalThis.fetch = async (path, ...more) => path === "/api/programs" ? new Response(list) : real(path, ...more);
      RUNS.request = async (message) => {
        asked.push([message.t, message.run ?? message.program]);
        if (message.t === "end") RUNS.state = { runs: [], ended: [] };
        else if (RUNS.state.runs.length) {
          return { ok: false, text: "error: /amcl of run m_navigate.1 would end [node-runs-already]" };
        }
        return { ok: true, text: "" };
      };
      page.panels.show(["programs"]);
      const soon = (get) => new Promise((done) => {
        const look = () => get() ? done(get()) : setTimeout(look, 20);
        look();
      });
      await soon(() => document.querySelector("#program-make_map"));
      RUNS.state = { runs: [run], ended: [] };
      const titles = [...document.querySelectorAll("#programs-panel .programs > details > summary")];
      const names = titles.map((e) => e.innerText.split(" (")[0]);
      document.querySelector("#program-make_map summary").click();
      (await soon(() => document.querySelector("#program-make_map .start"))).click();
      const button = await soon(() => document.querySelector("#program-make_map .problem button"));
      const text = button.textContent;
      button.click();
      await soon(() => asked.length === 3);
      page.panels.show([]); Object.assign(RUNS, { request, use, state: null }); globalThis.fetch = real;
      return [asked, text, names];
    })()""")
    assert found[0] == [["start", "make_map"], ["end", "m_navigate.1"], ["start", "make_map"]]
    assert found[1].startswith("End navigate, since ")
    assert found[1].endswith(" and start this")
    assert found[2] == ["Navigate", "Make a map", "Camera", "Other programs"]
