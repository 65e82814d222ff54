"""The panel of stored maps in a real browser: what it offers, what it sends, and what it answers."""

import json
from collections.abc import Iterator

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import STATE, PlayedRobot, wait

from ur.web.wire.frames import Kind

pytestmark = MARKS
FACTS = {
    "width": 4.0,
    "height": 2.0,
    "changed": 0,
    "places": 1,
    "latest": False,
    "problem": "",
    "picture": ["##", ".."],
}
MAPS = [{"name": "flat"} | FACTS, {"name": "hall"} | FACTS | {"problem": "not an image", "picture": []}]
RUN = {"run": "m_make_map.12", "title": "m_make_map", "started": 1.0, "nodes": [{"name": "/slam_gmapping"}]}


@pytest.fixture
def panel(browser: Chromium) -> Iterator[Chromium]:
    """The panel with two maps; `started` are the requests about runs."""
    browser.run(f"""
      Object.assign(globalThis, {{ started: [], fetched: globalThis.fetched ?? fetch }});
      globalThis.fetch = async (path, ...more) => {{
        if (!path.startsWith("/api/maps")) return fetched(path, ...more);
        return new Response(JSON.stringify({json.dumps(MAPS)}));
      }};
      page.runs.request = async (message) => (started.push(message), {{ ok: true, text: "" }});
      page.panels.show(["maps"]); 0""")
    wait(lambda: browser.run("document.querySelectorAll('#maps-panel li').length") == 2)
    yield browser
    browser.run("page.panels.show([]); delete page.runs.request; 0")


def press(browser: Chromium, label: str) -> None:
    browser.run(
        f"[...document.querySelectorAll('#maps-panel button')].find((e) => e.ariaLabel === '{label}').click(); 0"
    )


def show_map(robot: PlayedRobot, browser: Chromium, name: str, *, saves: bool = False) -> None:
    robot.show(Kind.STATE, STATE | {"map": {"name": name, "saves": saves}})
    wait(lambda: browser.run("[page.mapList.state.name, page.mapList.state.saves]") == [name, saves])


def list_buttons(browser: Chromium) -> list[list[str]]:
    rows: list[list[str]] = browser.run("""[...document.querySelectorAll('#maps-panel li')]
      .map((row) => [...row.querySelectorAll('button')].filter((e) => !e.disabled).map((e) => e.textContent))""")
    return rows


def test_map_in_use_is_marked_and_not_started(robot: PlayedRobot, panel: Chromium) -> None:
    show_map(robot, panel, "")
    wait(lambda: list_buttons(panel) == [["Drive on this map"], []])
    show_map(robot, panel, "flat")
    wait(lambda: list_buttons(panel) == [[], []])
    assert "in use" in panel.run("document.querySelector('#maps-panel [aria-current]').textContent")
    show_map(robot, panel, "")


def test_program_starts_on_the_map_that_was_chosen(robot: PlayedRobot, panel: Chromium) -> None:
    show_map(robot, panel, "")
    press(panel, "Drive on this map: flat")
    wait(lambda: panel.run("started.length") == 1)
    assert panel.run("started[0]") == {"t": "start", "program": "keyboard_navigate", "arguments": {"map": "flat"}}


def test_map_is_saved_on_request_and_its_program_is_ended_before_another_map_is_used(
    robot: PlayedRobot, panel: Chromium
) -> None:
    show_map(robot, panel, "", saves=True)
    panel.run("document.getElementById('map-save').click(); 0")
    wait(lambda: robot.find("save_map"))
    assert panel.run("document.getElementById('map-save').disabled")
    panel.run("page.take({ t: 'refused', what: 'save_map', why: 'the disk is full' }); 0")
    assert panel.run("page.mapList.answer.textContent") == "Not saved: the disk is full."
    panel.run("page.take({ t: 'done', what: 'save_map', name: 'flat' }); 0")
    assert panel.run("[page.mapList.answer.textContent, page.mapList.save.disabled]") == ["Saved as flat.", False]
    panel.run("page.runs.state = null; 0")
    press(panel, "Drive on this map: flat")
    assert "is being made" in panel.run("document.querySelector('#maps-panel .problem').textContent")
    panel.run(f"page.runs.state = {{ runs: [{json.dumps(RUN)}], ended: [] }}; 0")
    press(panel, "Drive on this map: flat")
    assert panel.run("started") == []
    panel.run("document.querySelector('#maps-panel .problem button').click(); 0")
    wait(lambda: panel.run("started.length") == 1)
    assert panel.run("started[0]") == {"t": "end", "run": "m_make_map.12"}
    panel.run("page.runs.state = { runs: [], ended: [] }; 0")
    wait(lambda: panel.run("started.length") == 2)
    assert panel.run("started[1].t") == "start"
    show_map(robot, panel, "")
    assert not panel.run("document.getElementById('map-save').checkVisibility()")


def test_page_drops_what_it_knew_when_nothing_runs_and_names_another_selection(
    robot: PlayedRobot, panel: Chromium
) -> None:
    show_map(robot, panel, "", saves=True)
    zone = {"name": "stairs", "percent": 0, "corners": [[0, 0], [1, 0], [1, 1]]}
    robot.show(Kind.ZONES, {"served": True, "zones": [zone], "problem": ""})
    walls = {"name": "flat", "restorable": True, "why": ""}
    robot.show(Kind.STATE, STATE | {"limit": 40, "map": {"name": "", "saves": True, "walls": walls}})
    robot.show(Kind.PLACES, {"named": True, "places": {"desk": [0, 0, 0]}, "problem": ""})
    wait(lambda: panel.run("Object.keys(page.map.places)") == ["desk"])
    known = """[page.walls.state.name, document.querySelector("#speed-limit").value,
      document.querySelector("#speed-limit").disabled, document.querySelectorAll("#zones-panel li").length,
      document.querySelector("#zones-panel form").hidden]"""
    assert panel.run(known) == ["flat", "40", False, 1, False]
    panel.run("page.runs.state = { runs: [], ended: [] }; 0")
    with robot.ended():
        wait(
            lambda: "Nothing runs on bob. Start a program." in panel.run("document.getElementById('banners').innerText")
        )
        assert panel.run("[page.state, page.map.pose, page.mapList.state.saves]") == [None, None, False]
        assert panel.run("page.map.places") == {}
        assert panel.run(known) == ["", "100", True, 0, True]
        assert "known when the robot is connected" in panel.run("document.querySelector('#speed-panel').textContent")
        assert not panel.run("document.getElementById('map-save').checkVisibility()")
        press(panel, "Drive on this map: flat")
        wait(lambda: panel.run("started.length") == 1)
        assert panel.run("started[0].program") == "keyboard_navigate"
        robot.move("sim --ros 2")
        wait(lambda: "has selected 'sim --ros 2'" in panel.run("document.getElementById('banners').innerText"))
        assert "Programs" not in panel.run("document.getElementById('banners').innerText")
        robot.move("")
        panel.run("globalThis.old = true; location.reload(); 0")
        wait(lambda: panel.holds("!globalThis.old && globalThis.page?.server?.end === 'no master'"))
        assert panel.run("page.state") is None, "the server has dropped it, too"
    wait(lambda: panel.holds("page.state && page.map.pose"))
