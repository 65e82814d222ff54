"""The page with a keyboard and with a screen reader: names, focus and announcements of every panel."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS, PROGRAM
from tests.web.static.played_robot import PLOT, STATE, PlayedRobot, wait

from ur.web.server.static_files import FOLDER
from ur.web.wire.frames import Kind

pytestmark = MARKS
GROUPS = {
    "Drive": ["places", "route", "speed", "assistants", "devices"],
    "Map": ["map_tools", "maps", "zones", "layers"],
    "Sensors": ["camera", "scene", "plots"],
    "Programs": ["programs", "runs", "recordings"],
    "Diagnostics": ["status", "doctor", "topics"],
}
PANELS = [name for names in GROUPS.values() for name in names]
CONTROLS = {
    "button", "checkbox", "combobox", "DisclosureTriangle", "img", "image", "link", "listbox", "log", "menuitem",
    "PopUpButton", "radio", "searchbox", "slider", "spinbutton", "switch", "tab", "textbox",
}  # fmt: skip
CORNERS = [[0, 0], [1, 0], [1, 1]]
TRUTH = ("true", "false")
ARGUMENTS = [
    {"name": "world", "doc": "The world.", "default": "office", "values": [{"text": "office", "help": "an office"}]},
    {"name": "debug", "doc": "", "default": "false", "values": [{"text": text, "help": ""} for text in TRUTH]},
]  # fmt: skip
COMMAND = {"on": "here", "command": "ls", "fix": True}
MAP_FACTS = {"width": 4.0, "height": 2.0, "changed": 1.7e9, "places": 1, "latest": True}
ANSWERS = {
    "/api/programs": [
        {"name": "make_map", "summary": "Make a map.", "lack": "", "problem": "", "file": True, "arguments": ARGUMENTS}
    ],
    "/api/nodes": ["/amcl"],
    "/api/explain": "amcl.launch starts it",
    "/api/graph": "<svg xmlns='http://www.w3.org/2000/svg'/>",
    "/api/sessions": [
        {"id": "a", "name": "Linux", "role": "drive", "address": "127.0.0.1", "own": True, "open": True}
        | {"first": 1.7e9, "last": 1.7e9, "until": 2e9},
        {"id": "b", "name": "iPhone", "role": "look", "address": "192.168.1.9", "own": False, "open": False}
        | {"first": 1.7e9, "last": 1.7e9, "until": 2e9},
    ],
    "/api/recordings": {
        "running": {"size": 1000, "seconds": 61, "topics": 2},
        "end": "stopped by Linux",
        "files": [{"name": "2026-03-01_14-05-31_0.bag", "size": 1000, "started": 1.7e9, "part": 1, "cut": True}],
    },
    "/api/recordings/topics": [{"name": "/scan", "kind": "sensor_msgs/LaserScan"}],
    "/api/maps": [
        {"name": "flat", "picture": ["##", ".."], "problem": ""} | MAP_FACTS,
        {"name": "hall", "picture": [], "problem": "not an image"} | MAP_FACTS,
    ],
    "/api/doctor": {
        "findings": [{"rule": "x", "message": "m", "help": "h", "commands": [COMMAND]}],
        "steps": [],
    },
}  # fmt: skip
NODE = {
    "name": "/amcl", "core": False, "state": "running", "ready": True, "held": False, "missing": [], "reason": "",
    "signal": None, "exit_code": None, "restart_in": None, "restarts": 0, "cpu": 0.1, "memory": 1000000,
}  # fmt: skip
RUN = {"run": "m_make_map.12", "title": "make_map", "started": 1.0, "stopping": None, "lost": None, "nodes": [NODE]}
# What can have the focus now: a text for each, in the order of the document.
FOCUSABLE = """
const nameOf = (e) => e.id || `${e.closest("aside, nav")?.id} ${e.localName} ${e.ariaLabel ?? e.textContent}`;
const focusable = () => [...document.querySelectorAll("button, input, select, summary, a[href], [tabindex='0']")]
  .filter((e) => e.checkVisibility({ visibilityProperty: true }) && !e.disabled).map(nameOf);
"""
# The focused element, and what is wrong with the way in which it is shown.
FOCUSED = """(() => {
  const e = document.activeElement, style = getComputedStyle(e), wrong = [];
  const width = parseFloat(style.outlineWidth), reach = width + parseFloat(style.outlineOffset);
  if (style.outlineStyle === "none" || width < 2) wrong.push("no outline");
  if (reach <= 0 && style.outlineColor === style.backgroundColor) wrong.push("outline in the colour of the control");
  const box = e.getBoundingClientRect();
  for (let at = e.parentElement; at && at !== document.body; at = at.parentElement) {
    const clip = at.getBoundingClientRect();
    if (getComputedStyle(at).overflowX === "hidden" && reach > 0 &&
        (box.left - reach < clip.left - 0.5 || box.right + reach > clip.right + 0.5)) wrong.push("outline cut off");
  }
  return [nameOf(e), wrong.join()];
})()"""


@pytest.fixture(scope="module")
def browser(robot: PlayedRobot, browser: Chromium) -> Chromium:
    """The page with something in every panel."""
    robot.show(Kind.PLACES, {"named": True, "places": {"desk": [0, 0, 0], "door": [1, 0, 0]}, "problem": ""})
    zones = [{"name": "stairs", "percent": 0, "corners": CORNERS}]
    robot.show(Kind.ZONES, {"served": True, "zones": zones, "problem": ""})
    browser.run(f"""{FOCUSABLE} Object.assign(globalThis, {{ nameOf, focusable }});
      const answers = {json.dumps(ANSWERS)}, real = fetch;
      globalThis.fetch = async (path, ...more) => {{
        const answer = answers[path.split("?")[0]];
        if (answer === undefined) return real(path, ...more);
        return new Response(typeof answer === "string" ? answer : JSON.stringify(answer));
      }}; 0""")
    wait(lambda: browser.run("document.querySelectorAll('#zones-panel li').length") == 1)
    return browser


def open_panel(browser: Chromium, name: str) -> None:
    """Open a panel and all that it can show."""
    browser.run(f"if (page.panels.open !== '{name}') page.panels.toggle('{name}'); 0")
    if name == "plots":
        wait(lambda: browser.holds(f"document.querySelector('[data-plot=\"{PLOT}\"]')"))
        browser.run(f"page.plots.size || document.querySelector('[data-plot=\"{PLOT}\"]').click(); 0")
    elif name == "programs":
        wait(lambda: browser.holds("document.querySelector('#program-make_map')"))
        browser.run("for (const each of document.querySelectorAll('#programs-panel details')) each.open = true; 0")
        wait(lambda: browser.holds("document.querySelector('#program-make_map form')"))
        browser.run("for (const each of document.querySelectorAll('#programs-panel details')) each.open = true; 0")
    elif name == "runs":
        state = {"runs": [RUN], "ended": []}
        browser.run(f"for (const show of page.runs.onState) show({json.dumps(state)}); 0")
    elif name == "devices":
        wait(lambda: browser.run("document.querySelectorAll('#devices-panel li').length") == 2)
    elif name == "maps":
        wait(lambda: browser.holds("document.querySelectorAll('#maps-panel li').length === 2"))
    elif name == "recordings":
        wait(lambda: browser.holds("document.querySelector('#recordings-panel a')"))
        browser.run("document.querySelector('#recordings-panel details').open = true; 0")
        wait(lambda: browser.holds("document.querySelector('#recordings-panel input')"))
    elif name == "doctor":
        wait(lambda: browser.holds("document.querySelector('#doctor-panel section')"))


def list_nameless(browser: Chromium) -> list[str]:
    """The roles of controls and pictures without a name in the accessibility tree."""
    found = []
    for node in browser.ask("Accessibility.getFullAXTree")["nodes"]:
        role = node.get("role", {}).get("value", "")
        if not node["ignored"] and role in CONTROLS and not node.get("name", {}).get("value", "").strip():
            found.append(f"{role} {node.get('properties')}")
    return found


# Controls whose name does not begin with the text that is seen on them, by which voice control looks for them.
MISNAMED = r"""[...document.querySelectorAll("button, a[href]")].filter((e) => e.checkVisibility() && e.ariaLabel)
  .filter((e) => /\w/.test(e.innerText) && !e.ariaLabel.toLowerCase().startsWith(e.innerText.trim().toLowerCase()))
  .map((e) => `${e.innerText}: ${e.ariaLabel}`)"""


def press_tab_round(browser: Chromium) -> dict[str, str]:
    """Press Tab from the map, once round the page: what has the focus in turn, and what is wrong with it."""
    browser.run("document.getElementById('map').focus(); 0")
    found: dict[str, str] = {}
    for _ in range(150):
        browser.press("Tab")
        if browser.run("document.activeElement === document.body"):  # between the last control and the first
            continue
        name, wrong = browser.run(FOCUSED)
        found[name] = wrong
        if name == "map":
            return found
    raise AssertionError(f"the map is not reached again: {list(found)}")


@pytest.mark.parametrize("name", PANELS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_controls_of_panel_have_names_and_a_visible_focus_in_reach_of_tab(
    browser: Chromium, name: str, scheme: str, tmp_path: Path
) -> None:
    still = {"name": "prefers-reduced-motion", "value": "reduce"}  # no colour is between two others
    browser.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}, still])
    open_panel(browser, name)
    assert list_nameless(browser) == []
    assert browser.run(MISNAMED) == []
    wanted = browser.run("focusable()")
    found = press_tab_round(browser)
    (tmp_path / f"{name}.png").write_bytes(browser.screenshot())
    assert [each for each in wanted if each not in found] == []
    assert {each: wrong for each, wrong in found.items() if wrong} == {}
    browser.press("Escape")
    assert browser.run("[page.panels.open, document.activeElement.id]") == ["", name]


LISTED = """Object.fromEntries([...document.querySelectorAll("#panels details")].map((group) =>
  [group.querySelector("summary").textContent, [...group.querySelectorAll("button")].map((each) => each.id)]))"""


SETTLED = "globalThis.page?.panels && page.state && page.drive.newest"


@pytest.fixture
def fresh(robot: PlayedRobot, tmp_path: Path) -> Iterator[Chromium]:
    """A browser that has not seen the page before."""
    assert PROGRAM is not None
    with Chromium(PROGRAM, tmp_path) as browser:
        browser.open(robot.link)
        wait(lambda: browser.holds(SETTLED))
        yield browser


def reload(browser: Chromium) -> None:
    browser.run("globalThis.page = null; location.assign('/'); 0")
    wait(lambda: browser.holds(SETTLED))


def test_each_panel_is_in_one_of_five_groups_and_the_last_used_is_first_when_a_group_is_opened(
    fresh: Chromium,
) -> None:
    for width in (1280, 390):
        fresh.resize(width, 844, phone=width == 390)
        fresh.run("localStorage.clear(); 0")
        reload(fresh)
        assert fresh.run(LISTED) == GROUPS
        assert sorted(fresh.run("[...page.panels.panels.keys()]")) == sorted(PANELS)
        fresh.run("page.panels.openMenu(true); 0")
        for name in ("layers", "zones", "speed"):
            group = f"document.getElementById('{name}').closest('details')"
            fresh.run(f"{group}.open || {group}.querySelector('summary').click(); 0")
            fresh.run(f"document.getElementById('{name}').click(); page.panels.openMenu(true); 0")
        used = GROUPS | {"Map": ["zones", "layers", "map_tools", "maps"]}
        used["Drive"] = ["speed", *(each for each in GROUPS["Drive"] if each != "speed")]
        fresh.run("page.panels.openMenu(false); page.panels.show([]); page.panels.reveal('doctor'); 0")
        wait(lambda used=used: fresh.run(LISTED) == used)
        reload(fresh)
        assert fresh.run(LISTED) == used
        seen = fresh.run("[...document.querySelectorAll('#panels [open] summary')].map((e) => e.textContent)")
        assert seen == ["Drive"], "the group that was used last"


def test_stop_is_the_first_stop_of_tab_and_the_space_bar_presses_it(fresh: Chromium) -> None:
    fresh.press("Tab")
    assert fresh.run("document.activeElement.id") == "stop"
    [stop] = [
        node
        for node in fresh.ask("Accessibility.getFullAXTree")["nodes"]
        if any(each["name"] == "focused" for each in node.get("properties", ())) and node["role"]["value"] == "button"
    ]
    assert stop["name"]["value"] == "STOP"
    assert {"keyshortcuts": "Space"}.items() <= {e["name"]: e["value"]["value"] for e in stop["properties"]}.items()
    fresh.run("document.activeElement.blur(); 0")
    fresh.run("page.drive.send = (message) => message.t === 'stop' && (globalThis.stopped = true); 0")
    fresh.ask("Input.dispatchKeyEvent", type="keyDown", key=" ", code="Space")
    wait(lambda: fresh.holds("globalThis.stopped"))


def test_texts_of_the_page_do_not_speak_of_a_terminal() -> None:
    texts = [(FOLDER / name).read_text() for name in ("texts.js", "data/texts.js")]
    assert [line for text in texts for line in text.splitlines() if "terminal" in line] == []


def heard(browser: Chromium, urgent: str = "") -> list[str]:
    lines: list[str] = browser.run(f"[...document.getElementById('heard{urgent}').children].map((e) => e.textContent)")
    return lines


def show(robot: PlayedRobot, **changes: Any) -> None:
    robot.show(Kind.STATE, STATE | {"bumpers": []} | changes)


def test_changes_are_announced_once(robot: PlayedRobot, browser: Chromium) -> None:
    tree = browser.ask("Accessibility.getFullAXTree")["nodes"]
    regions = {"status", "alert"} & {each.get("role", {}).get("value") for each in tree}
    assert regions == {"status", "alert"}
    goal = {"number": 5, "place": [1.0, 0.0, 0.0], "state": "driving", "text": "", "left": 4.0}
    show(robot, goal=goal)
    wait(lambda: browser.run("document.getElementById('goal-text').textContent").endswith("4.0 m left"))
    show(robot, goal=goal | {"left": 3.0})
    wait(lambda: browser.run("document.getElementById('goal-text').textContent").endswith("3.0 m left"))
    assert len([each for each in heard(browser) if each.startswith("Driving")]) == 1
    show(robot, goal=goal | {"state": "reached"})
    wait(lambda: any("eached" in each for each in heard(browser)))
    show(robot, mux=STATE["mux"] | {"stopped": True})
    wait(lambda: "Emergency stop: nothing drives." in heard(browser, "-now"))
    show(robot)
    wait(lambda: not browser.holds("document.querySelector('.banner.red')"))


def test_banner_keeps_its_focused_button_while_others_come(robot: PlayedRobot, browser: Chromium) -> None:
    lease = {"state": "lost", "client": "x", "name": "ann", "program": "web", "since": 1.0, "until": 60.0, "asking": []}
    show(robot, lease=lease)
    wait(lambda: browser.holds("document.querySelector('.banner button')"))
    browser.run("document.querySelector('.banner button').focus(); 0")
    show(robot, lease=lease | {"until": 120.0}, mux=STATE["mux"] | {"problem": "the mux is too old"})
    wait(lambda: browser.holds("document.querySelectorAll('.banner').length > 1"))
    assert browser.run("document.activeElement.textContent") == "Take over"
    show(robot)
    wait(lambda: not browser.holds("document.querySelector('.banner button')"))


def test_deletion_asks_in_the_name_of_the_button_and_the_focus_stays_in_the_panel(
    robot: PlayedRobot, browser: Chromium
) -> None:
    open_panel(browser, "places")
    browser.run("document.querySelector('[aria-label=\"Delete the place door\"]').focus(); 0")
    browser.press("Enter")
    assert browser.run("document.activeElement.ariaLabel") == "Sure? Delete the place door"
    browser.press("Enter")
    wait(lambda: robot.find("forget_place"))
    robot.show(Kind.PLACES, {"named": True, "places": {"desk": [0, 0, 0]}, "problem": ""})
    wait(lambda: browser.run("document.querySelectorAll('#places-panel li').length") == 1)
    assert browser.run("document.activeElement.id") == "places-panel"
    browser.run("page.panels.close(); 0")
