"""Slider, gamepad and plots of the page in a real browser; the robot's end is played by the test."""

import json
from pathlib import Path

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import PLOT, STATE, PlayedRobot, wait

from ur.web.wire.frames import Kind

pytestmark = MARKS
GOAL = {"number": 0, "place": [1.0, 0.0, 0.0], "state": "none", "text": "", "left": None}
GAMEPAD = """
const buttons = [...Array(16)].map(() => ({ pressed: false }));
globalThis.pad = { id: "pad", connected: true, axes: [0, 0, 0, 0], buttons };
navigator.getGamepads = () => [globalThis.pad];
dispatchEvent(new Event("gamepadconnected"));
page.setMode("drive");
0
"""


def test_slider_limits_the_speed_when_it_is_let_go(robot: PlayedRobot, browser: Chromium) -> None:
    browser.run("page.panels.toggle('speed'); 0")
    assert browser.run("document.getElementById('speed-limit').value") == "100"
    browser.run(
        "(() => { const slider = document.getElementById('speed-limit'); slider.value = '40';"
        " slider.dispatchEvent(new Event('input')); slider.dispatchEvent(new Event('change')); })()"
    )
    wait(lambda: robot.find("limit"))
    assert robot.find("limit") == [{"t": "limit", "percent": 40}]
    assert "joystick, page" in browser.run("document.getElementById('speed-panel').textContent")
    browser.run("page.panels.close(); 0")


def test_space_stops_wherever_the_focus_is_except_in_a_text(browser: Chromium) -> None:
    browser.run("globalThis.stopped = 0; page.stop = () => (stopped += 1)")
    browser.run("page.panels.show(['speed', 'layers']); 0")
    browser.run("document.body.append(document.createElement('textarea'), document.createElement('select')); 0")
    wait(lambda: browser.holds("document.querySelector('#layers-panel input')"))
    stopping = ("#speed-limit", "#layers-panel input", "#stop", "#map", "body > select")
    for count, wanted in enumerate(stopping, 1):
        browser.run(f"document.querySelector('{wanted}').focus(); 0")
        ticked = browser.run("document.activeElement.checked ?? null")
        browser.press(" ")
        assert browser.run("[stopped, document.activeElement.checked ?? null]") == [count, ticked], wanted
    browser.run("document.querySelector('#layers-panel input').focus(); 0")
    ticked = browser.run("document.activeElement.checked")
    browser.press("Enter")
    assert browser.run("document.activeElement.checked") is not ticked
    browser.press("Enter")
    browser.run("document.querySelector('body > textarea').focus(); 0")
    browser.press(" ")
    assert browser.run("[stopped, document.activeElement.value]") == [len(stopping), " "]
    browser.run("document.querySelectorAll('body > textarea, body > select').forEach((each) => each.remove())")
    browser.run("delete page.stop; page.panels.show([]); 0")


def test_bumper_that_is_pressed_is_named(browser: Chromium) -> None:
    wait(lambda: "Bumper pressed: front" in browser.run("document.getElementById('banners').textContent"))


def test_driver_who_is_out_of_reach_is_not_said_to_drive(robot: PlayedRobot, browser: Chromium) -> None:
    lease = {"client": "x", "name": "ann", "program": "web", "since": 1.0, "until": 60.0, "asking": []}
    for state, words in (("held", "ann drives"), ("lost", "No client drives")):
        robot.show(Kind.STATE, STATE | {"lease": lease | {"state": state}})
        wait(lambda words=words: browser.run("document.getElementById('driver').textContent") == words)
    robot.show(Kind.STATE, STATE)


def test_patrol_is_asked_of_the_robot_and_shown_as_the_robot_says(robot: PlayedRobot, browser: Chromium) -> None:
    patrol = {"state": "idle", "line": "", "stops": [], "index": 0, "loop": False}
    robot.show(Kind.STATE, STATE | {"patrol": patrol})
    robot.show(Kind.PLACES, {"named": True, "places": {"desk": [0, 0, 0], "door": [1, 0, 0]}, "problem": ""})
    browser.run("page.panels.toggle('places'); 0")
    wait(lambda: browser.run("document.querySelectorAll('#places-panel li').length") == 2)
    assert browser.run("document.getElementById('patrol').disabled")
    for name in ("door", "desk"):
        browser.run(f"document.querySelector('#places-panel input[aria-label=\"Patrol: {name}\"]').click(); 0")
    browser.run("document.getElementById('patrol').click(); 0")
    wait(lambda: robot.find("patrol"))
    (asked,) = robot.find("patrol")
    assert (asked["do"], asked["places"], asked["loop"]) == ("start", ["door", "desk"], False)
    lease = {"client": "patrol", "name": "patrol", "program": "", "since": 1.0, "until": None, "asking": []}
    shown = patrol | {"state": "waiting", "line": "patrol: waits at door (1 of 2)"}
    robot.show(Kind.STATE, STATE | {"patrol": shown, "lease": lease | {"state": "held"}})
    banner = "[...document.querySelectorAll('.banner')].find((each) => each.innerText.startsWith('Patrol'))"
    wait(lambda: browser.holds(f"{banner}?.innerText.includes('Patrol: waits at door (1 of 2)')"))
    assert browser.run("document.getElementById('driver').textContent") == "patrol drives"
    assert browser.run("document.getElementById('banners').innerText").count("drives") == 0  # said once
    browser.run(f"globalThis.pressed = {banner}.querySelector('button'); 0")  # a finger is on it as the robot goes on
    for line in ("patrol: drives to desk (2 of 2)", "patrol: waits at desk (2 of 2)"):
        robot.show(Kind.STATE, STATE | {"patrol": shown | {"line": line}})
        wait(lambda line=line: browser.holds(f"{banner}?.innerText.includes('{line[1:]}')"))
        assert browser.holds(f"pressed === {banner}.querySelector('button')")
    last = f"[...{banner}.querySelectorAll('button')].at(-1)"
    browser.run(f"globalThis.ending = {last}; pressed.click(); 0")
    place = browser.run("JSON.stringify(ending.getBoundingClientRect())")
    wait(lambda: [each["do"] for each in robot.find("patrol")] == ["start", "pause"])
    robot.show(Kind.STATE, STATE | {"patrol": shown | {"state": "paused", "line": "patrol paused: " + "by ann " * 30}})
    wait(lambda: browser.holds(f"{banner}?.innerText.includes('Continue')"))
    assert browser.holds(f"ending === {last} && ending.textContent === 'End the patrol'")
    assert browser.run("JSON.stringify(ending.getBoundingClientRect())") == place  # a finger may be on its way
    for _ in range(5):  # an answer, another page, the battery: a page starts nothing by itself
        robot.show(Kind.STATE, STATE | {"patrol": patrol, "goal": GOAL | {"number": 1, "state": "reached"}})
        robot.show(Kind.STATE, STATE | {"patrol": patrol})
    wait(lambda: browser.holds(f"!{banner}"))
    assert [each["do"] for each in robot.find("patrol")] == ["start", "pause"]
    assert robot.find("go_to") == []
    robot.show(Kind.STATE, STATE)
    browser.run("page.panels.close(); 0")


def test_exploration_is_shown_until_its_end_and_after_it(robot: PlayedRobot, browser: Chromium) -> None:
    lease = {"client": "", "name": "", "program": "", "since": 0.0, "until": None, "asking": [], "state": "free"}
    for state, line, driver in (
        ("exploring", "72 m² known, 85 m driven; 22 frontiers left", "exploring drives"),
        ("complete", "the map is complete: 0 frontiers reachable; 5 corners left out", "No client drives"),
    ):
        robot.show(Kind.STATE, STATE | {"lease": lease, "exploring": {"state": state, "line": line}})
        wait(lambda driver=driver: browser.run("document.getElementById('driver').textContent") == driver)
        assert line[3:] in browser.run("document.getElementById('banners').innerText")
    robot.show(Kind.STATE, STATE)


def test_command_of_the_doctor_is_copied_by_its_button_or_else_selected(browser: Chromium) -> None:
    command = "sudo apt-get install chrony"
    finding = {"rule": "x", "message": "m", "help": "", "commands": [{"on": "bob", "command": command, "fix": False}]}
    answer = json.dumps({"findings": [finding], "steps": []})
    browser.run(f"globalThis.real = fetch; fetch = async () => new Response({answer!r}); 0")
    browser.run("page.panels.toggle('doctor'); 0")
    button = "document.querySelector('#doctor-panel .command button')"
    wait(lambda: browser.holds(button))
    assert browser.run(f"{button}.ariaLabel") == f"Copy {command}"
    for refused, text in (("", "Copied"), ("throw 0", "Selected: copy it with Ctrl-C")):
        browser.run(f"navigator.clipboard.writeText = async (text) => {{ copied = text; {refused} }}; 0")
        browser.run(f"{button}.click(); 0")
        wait(lambda text=text: browser.run(f"{button}.textContent") == text)
        assert browser.run("copied") == command
        assert browser.run("getSelection().toString()").strip() == command
    browser.run("fetch = real; page.panels.close(); 0")


def test_gamepad_drives_while_its_stick_is_pushed_and_its_button_stops(robot: PlayedRobot, browser: Chromium) -> None:
    browser.run("document.hasFocus = () => true; 0")
    browser.run(GAMEPAD)
    wait(lambda: browser.run("page.gamepads.state") == "idle")
    browser.run("pad.axes = [0, -1, 0, 0]; 0")
    wait(lambda: robot.find("stick"))
    assert {each["forward"] for each in robot.find("stick")} == {0.5}
    browser.run("pad.axes = [0, 0, 0, 0]; 0")
    wait(lambda: robot.find("let_go"))
    assert robot.find("stop") == []
    browser.run("pad.buttons[1].pressed = true; 0")
    wait(lambda: robot.find("stop"))
    browser.run("pad.connected = false; page.setMode('look'); 0")


def test_plot_is_ticked_drawn_and_in_the_address(browser: Chromium, tmp_path: Path) -> None:
    browser.run("page.panels.toggle('plots'); 0")
    wait(lambda: browser.holds("document.querySelector('#plots-panel input')"))
    browser.run("document.querySelector('#plots-panel input').click(); 0")
    wait(lambda: browser.run("location.search") == f"?plots={PLOT}")
    wait(lambda: browser.run("(document.querySelector('#plots-panel output')?.textContent ?? '\u2013') !== '\u2013'"))
    assert browser.run("document.querySelector('#plots-panel canvas').ariaLabel").startswith("Speed (m/s)")
    (tmp_path / "plots.png").write_bytes(browser.screenshot())
    browser.run("globalThis.page = null; location.reload(); 0")
    wait(lambda: browser.holds("globalThis.page?.panels?.open === 'plots' && page.plots.size === 1"))
    browser.run("page.panels.close(); 0")
    assert browser.run("location.search") == ""


def test_neighbouring_ticks_of_a_plot_have_different_numbers(browser: Chromium) -> None:
    ticks = "[[16.58, 0.005], [16.585, 0.005], [16.59, 0.005], [250.02, 0.02], [250.04, 0.02], [0.5, 0.5], [10, 5]]"
    made = browser.run(f"import('/plot_series.js').then((all) => {ticks}.map((each) => all.shortNumber(...each)))")
    assert made == ["16.58", "16.585", "16.59", "250.02", "250.04", "0.5", "10"]


def test_names_of_topics_and_types_break_between_words_only(browser: Chromium) -> None:
    names = ["/move_base/global_costmap/costmap_updates", "geometry_msgs/PoseWithCovarianceStamped"]
    rows = json.dumps([[*names, 1, 1, 1.0, 1.0], ["/base_pose_ground_truth", "nav_msgs/Odometry", 1, 0, 10.0, 100.0]])
    browser.run("page.panels.show(['topics']); 0")
    wait(lambda: browser.holds("document.querySelector('#topics-panel table')"))
    browser.run(f"import('/data/data_socket.js').then((all) => all.DATA.tell('topics', {{ rows: {rows} }}))")
    parts = """[...document.querySelectorAll('#topics-panel tbody tr')].map((row) => [...row.cells].slice(0, 2)
      .map((cell) => [cell.textContent, [...(cell.querySelector('button') ?? cell).childNodes].filter((part) => {
        const range = document.createRange();
        range.selectNode(part);
        return new Set([...range.getClientRects()].map((each) => each.top)).size > 1;
      }).map((part) => part.textContent)]))"""
    first, second = browser.run(parts)
    assert first == [[name, []] for name in names]
    assert second == [["/base_pose_ground_truth", []], ["nav_msgs/Odometry", []]]
    browser.run("page.panels.show([]); 0")


def test_base_that_drives_sideways_does_so_by_shift_or_its_button(robot: PlayedRobot, browser: Chromium) -> None:
    shown = "document.getElementById('sideways').checkVisibility()"
    browser.run("page.setMode('drive'); 0")
    assert not browser.holds(shown), "its wheels do not roll sideways"
    robot.show(Kind.STATE, STATE | {"robot": STATE["robot"] | {"limits": [0.5, 1.0, 0.4]}})
    wait(lambda: browser.holds(shown))

    def push(shift: bool) -> tuple[float, float]:
        keys = f"code: 'ArrowLeft', key: 'ArrowLeft', shiftKey: {str(shift).lower()}"
        browser.run(f"dispatchEvent(new KeyboardEvent('keydown', {{{keys}}})); 0")
        moved = browser.run("[page.drive.turn, page.drive.left]")
        browser.run(f"dispatchEvent(new KeyboardEvent('keyup', {{{keys}}})); 0")
        return moved[0], moved[1]

    assert push(shift=False) == (1.0, 0.0)
    assert push(shift=True) == (0.0, 0.4)
    browser.run("document.getElementById('sideways').click(); 0")
    assert push(shift=False) == (0.0, 0.4)
    browser.run("document.getElementById('sideways').click(); page.setMode('look'); 0")
    assert not browser.holds(shown)
    robot.show(Kind.STATE, STATE)
