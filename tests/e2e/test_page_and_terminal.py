"""The page and the terminal tell the same of a robot, on ROS 1 and ROS 2."""

import json
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT, UrShell
from tests.e2e.terminal import ProgramTerminal
from tests.e2e.web_page import PROGRAM, BrowserPage, open_first, start_server

pytestmark = [
    pytest.mark.ros,
    pytest.mark.timeout(600),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
]
pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

BANNERS = "document.getElementById('banners').innerText"
NOTHING = f"{BANNERS} === 'Nothing runs on the simulated robot. Start a program.\\nPrograms'"
SHOWN_MAPS = "[...document.querySelectorAll('#maps-panel li b')].map((each) => each.textContent)"
MAZE = str(ROOT / "ubiquity_launches/n_map_server/maps/maze.yaml")


def compare_maps(page: BrowserPage, shell: UrShell, *names: str) -> None:
    """Page and terminal list these maps."""
    page.run("page.mapList.load(); 0")
    page.wait(f"{SHOWN_MAPS}.join() === '{','.join(names)}'")
    listed = json.loads(shell.ur("maps", "--json").stdout)
    assert [each["name"] for each in listed] == list(names)


def test_page_and_terminal_have_one_list_of_places_and_maps_and_follow_end_and_selection(
    shell_of_either: UrShell, tmp_path: Path
) -> None:
    shell = shell_of_either
    selected = shell.ur("use").stdout
    assert shell.ur("maps", "import", MAZE, "flat").returncode == 0
    with start_server(shell.environment, tmp_path) as server, open_first(server, tmp_path) as browser:
        page = BrowserPage(browser)
        page.wait(f"globalThis.page?.socket.age < 1 && {NOTHING}")
        assert shell.ur("ps").stderr == "no run is active\n"
        command = [str(ROOT / "ur"), "run", "keyboard_navigate", "use_rviz:=false"]
        with ProgramTerminal(command, shell.environment) as terminal:
            page.wait("page.map.tiles.tiles.size && page.map.pose && page.state && page.drive.newest", 120)
            terminal.wait_for("localised")
            terminal.type("w desk\r")
            page.wait("page.map.places.desk")
            page.run("page.sendPlace({t: 'name_place', place: 'door', x: 0.7, y: 0, yaw: 0}); 0")
            page.wait("Object.keys(page.map.places).sort().join() === 'desk,door'")
            terminal.forget()
            terminal.type("l\r")
            terminal.wait_for("door")
            page.run("page.panels.show(['maps']); 0")
            compare_maps(page, shell, "flat")
            assert shell.ur("maps", "rename", "flat", "attic").returncode == 0
            compare_maps(page, shell, "attic")
            terminal.type("q\r")
            terminal.wait_for("a page uses this robot")
            terminal.type("q\r")
            terminal.process.wait(60)
        page.wait(NOTHING)
        assert page.run("[page.state, page.map.pose, page.map.places]") == [None, None, {}]
        assert shell.ur("ps").stderr == "no run is active\n"
        own, other = ("2", "1") if "--ros 2" in selected else ("1", "2")
        assert shell.ur("use", "sim", "--ros", other).returncode == 0
        now_selected = shell.ur("use").stdout
        assert now_selected != selected
        page.wait(f"{BANNERS}.startsWith(\"'ur use' has selected '{now_selected.strip()}'\")")
        assert shell.ur("use", "sim", "--ros", own).returncode == 0
        page.wait(NOTHING)
