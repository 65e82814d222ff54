"""The page beside an exploration, in a real browser with the real simulator."""

import contextlib
import subprocess
from collections.abc import Iterator

import pytest
from tests.e2e.conftest import ROOT, end, make_environment
from tests.e2e.web_page import PROGRAM, BrowserPage, open_first, start_server

pytestmark = [
    pytest.mark.ros,
    pytest.mark.timeout(600),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
]
pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

EXPLORES = "page.state.exploring?.state === 'exploring'"
MINE = "page.state.lease?.state === 'held' && page.state.lease.client === page.drive.client"
HEAD = "document.getElementById('driver').textContent"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[BrowserPage]:
    """A page of a robot that explores the maze."""
    folder = tmp_path_factory.mktemp("exploration")
    env = make_environment(folder)
    command = [
        str(ROOT / "ur"),
        "run",
        "make_map",
        "explore:=true",
        "map:=maze",
        "use_rviz:=false",
        "robot_base:=stage",
    ]
    with (folder / "run.log").open("w") as output:
        run = subprocess.Popen(
            command, env=env, stdin=subprocess.DEVNULL, stdout=output, stderr=output, text=True, cwd=folder
        )
    try:
        with start_server(env, folder) as server, open_first(server, folder / "chromium") as browser:
            page = BrowserPage(browser)
            page.wait(f"globalThis.page?.map.tiles.tiles.size && page.map.pose && page.drive.newest && {EXPLORES}", 120)
            yield page
    finally:
        end(run)


def send(page: BrowserPage, place: str) -> None:
    """Send a goal until it is not late: a busy computer may be too slow."""
    for _ in range(10):
        page.run(f"page.setMode('goal'); page.point({place}); 0")
        with contextlib.suppress(AssertionError):
            page.wait("page.state.exploring.state === 'paused'", 6)
            return
    raise AssertionError(f"no goal arrives in time: {page.explain()}")


def test_page_shows_an_exploration_as_the_terminal_does(page: BrowserPage) -> None:
    page.wait(f"{HEAD} === 'exploring drives'")
    page.wait("/^\\d+ m² known, .* left, about/.test(document.getElementById('banners').innerText)")
    page.wait("page.overlays.found.get(12)?.frontiers.length > 0")


def test_exploration_goes_on_after_a_goal_of_the_page_was_refused(page: BrowserPage) -> None:
    send(page, "{ x: 900, y: 900, yaw: 0 }")
    page.wait(f"page.state.lease.state === 'free' && {EXPLORES}")


def test_exploration_goes_on_after_a_goal_of_the_page_was_reached(page: BrowserPage) -> None:
    send(page, "{ x: page.pose.x, y: page.pose.y, yaw: null, dragged: false }")
    page.wait(f"page.state.lease.state === 'free' && {EXPLORES}")


@pytest.mark.parametrize("button", ["#hand-back", "#mode-look"])
def test_lease_is_handed_back_by_its_button_and_by_look(page: BrowserPage, button: str) -> None:
    page.run("page.drive.request({ t: 'lease', do: 'take' }); 0")
    page.wait(f"{MINE} && document.getElementById('hand-back').checkVisibility()")
    assert page.run(HEAD).startswith("You drive")
    page.tap(button)
    page.wait(
        f"page.state.lease.state === 'free' && {EXPLORES} && !document.getElementById('hand-back').checkVisibility()"
    )
