"""The panels of the page that show data of the robot, in a real browser with the real simulator."""

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.chromium import Chromium
from tests.e2e.conftest import PYTHON, ROOT, LaunchedRobot, end
from tests.e2e.test_web_page import DESK, server
from tests.e2e.web_page import PROGRAM, BrowserPage

__all__ = ["server"]  # a fixture

pytestmark = [
    pytest.mark.ros,
    pytest.mark.timeout(600),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
]


WEBGL = ("--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader")


@pytest.fixture(scope="module")
def browser(server: tuple[int, Path], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    assert PROGRAM is not None
    with Chromium(PROGRAM, tmp_path_factory.mktemp("chromium"), *WEBGL) as browser:
        link = re.search(r"http\S+", server[1].read_text())
        assert link
        browser.open(link[0])
        yield browser


@pytest.fixture
def page(browser: Chromium, robot: LaunchedRobot) -> Iterator[BrowserPage]:
    assert robot.launch.poll() is None
    page = BrowserPage(browser)
    browser.resize(*DESK)
    page.wait("globalThis.page?.state && page.map.pose")
    browser.complaints.clear()
    yield page
    page.run("page.panels.show([]); 0")
    assert browser.faults == []


def press(page: BrowserPage, selector: str) -> None:
    """Press the first control that is in sight, as soon as it is there."""
    button = f"[...document.querySelectorAll({selector!r})].find((e) => e.checkVisibility())"
    page.wait(button)
    page.run(f"{button}.click(); 0")


def open_row(page: BrowserPage, name: str) -> None:
    """Open a topic by its name in the list."""
    button = f"[...document.querySelectorAll('#topics-panel .go')].find((e) => e.textContent === '{name}')"
    page.wait(f"{button}?.checkVisibility()")
    page.run(f"{button}.click(); 0")


def test_topic_is_measured_and_printed(page: BrowserPage) -> None:
    page.run("page.panels.show(['topics']); 0")
    page.wait("globalThis.page.topicPanel")
    page.run("document.getElementById('topic-filter').value = 'odometry'; page.topicPanel.draw(); 0")
    page.wait("[...document.querySelectorAll('table.topics tr')].some((e) => /odom[^]*[0-9] Hz/.test(e.innerText))")
    open_row(page, "/odom")
    page.wait("document.getElementById('topic-message').textContent.includes('child_frame_id: \"base_')")


@pytest.fixture
def scene(robot: LaunchedRobot) -> Iterator[None]:
    """A node that publishes clouds, markers and diagnostics."""
    process = subprocess.Popen([str(PYTHON), "-m", "tests.e2e.scene_node"], cwd=ROOT, env=robot.env)
    yield
    end(process)


@pytest.mark.usefixtures("scene")
def test_scene_shows_robot_cloud_and_markers_in_their_frames(page: BrowserPage) -> None:
    page.run("page.panels.show(['scene']); 0")
    page.wait("globalThis.page.scenePanel?.view?.model.length > 3 && page.scenePanel.view.root === 'map'", 120)
    page.wait("document.querySelectorAll('#scene-panel li input').length === 2")
    page.run("for (const each of document.querySelectorAll('#scene-panel li input')) each.click(); 0")
    page.wait("page.scenePanel.view.topics.get('/cloud')?.length === 1")
    page.wait("page.scenePanel.view.topics.get('/markers')?.length === 6")  # without the one that is not finite
    assert page.run("page.scenePanel.view.topics.get('/cloud')[0].geometry.attributes.position.count") == 3085
    base = page.run("page.scenePanel.view.find('base_link').elements.slice(12, 14)")
    assert base == pytest.approx(page.run("[page.pose.x, page.pose.y]"), abs=0.2)
    drawn = page.run("page.scenePanel.view.drawn")
    page.wait(f"page.scenePanel.view.drawn > {drawn}")


@pytest.mark.usefixtures("scene")
def test_status_shows_diagnostics_by_level(page: BrowserPage) -> None:
    page.run("page.panels.show(['status']); 0")
    page.wait("document.querySelectorAll('#status-panel .components details').length === 2")
    lines = page.run("[...document.querySelectorAll('#status-panel .components summary')].map((e) => e.textContent)")
    assert lines == ["Error: lidar <img src=x>, no\\x1b[2J word", "OK: motors, fine"]
