"""`ur run keyboard_navigate navigation:=nav2`: pipe and page drive the robot by Nav2's action, in one run.

Nav2 is a stand-in of rclpy, with messages that ROS 2's generators have made.
"""

import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import pytest
from tests.e2e.conftest import ROOT, UrShell, end
from tests.e2e.matrix_ros2 import ros2_environment
from tests.e2e.web_page import PROGRAM, BrowserPage, open_first, start_server
from tests.ros2_messages import add_messages
from tests.ros2_session import PYTHON, free_domain

NAV2 = Path(__file__).with_name("nav2_stand_in.py")
BUTTON = "[...document.querySelectorAll('button')].find((each) => each.textContent === 'TEXT')"
NODE = ROOT / "ubiquity_launches/lib/node"

pytestmark = [
    pytest.mark.timeout(600),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
    pytest.mark.skipif(not PYTHON.exists(), reason="no wheels of ROS 2 for this processor"),
]
pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")


@dataclass
class Run:
    """The program with piped commands, Nav2, and the page."""

    program: subprocess.Popen[str]
    page: BrowserPage
    errors: Path

    def drive(self, line: str) -> None:
        print(line, file=self.program.stdin, flush=True)

    def result(self) -> str:
        assert self.program.stdout is not None
        return self.program.stdout.readline()

    def finish(self) -> int:
        assert self.program.stdin is not None
        self.program.stdin.close()
        return self.program.wait(60.0)


@contextmanager
def running(command: list[str], environment: dict[str, str], errors: IO[str]) -> Iterator[subprocess.Popen[str]]:
    pipe = subprocess.PIPE
    program = subprocess.Popen(command, env=environment, stdin=pipe, stdout=pipe, stderr=errors, text=True)
    try:
        yield program
    finally:
        end(program)
        for each in (program.stdin, program.stdout):
            assert each is not None
            each.close()


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Run]:
    shell = UrShell(tmp_path)
    domain = free_domain()
    shell.environment |= {"ROS_DOMAIN_ID": domain, "XDG_RUNTIME_DIR": str(tmp_path), "PYTHONPATH": ""}
    add_messages(shell.environment)
    messages = shell.environment["PYTHONPATH"].strip(os.pathsep)
    shell.environment["ROS_PACKAGE_PATH"] += f":{messages}"
    assert shell.ur("use", "sim", "--ros", "2").returncode == 0
    command = [str(ROOT / "ur"), "run", "keyboard_navigate", "navigation:=nav2", "use_rviz:=false"]
    errors = tmp_path / "run.txt"
    with (
        errors.open("w") as output,
        running([str(NODE), str(NAV2)], shell.environment | ros2_environment(tmp_path, domain), output),
        running(command, shell.environment, output) as program,
        start_server(shell.environment, tmp_path) as server,
        open_first(server, tmp_path) as browser,
    ):
        page = BrowserPage(browser)
        page.wait("globalThis.page?.map.tiles.tiles.size && page.map.pose && page.state && page.drive.newest")
        browser.complaints.clear()
        yield Run(program, page, errors)
        assert browser.complaints == []
    assert "Traceback" not in errors.read_text()


def test_pipe_and_page_drive_by_nav2_and_the_page_shows_its_goal_plan_and_costmaps(run: Run) -> None:
    page = run.page
    page.run("document.getElementById('layers').click(); 0")
    for name in ("local", "global"):
        page.run(f"document.getElementById('layer-{name}').click(); 0")
    run.drive("g 1 0 0")
    page.wait("page.state.goal.state === 'driving' && page.map.plan.length === 4")
    assert page.run("page.state.goal.place") == [1.0, 0.0, 0.0]
    assert page.run("[...page.map.plan].slice(2)") == pytest.approx([1.0, 0.0], abs=0.01)
    page.wait("page.map.costs.local.tiles.size && page.map.costs.global.tiles.size")
    assert run.result().startswith("g 1 0 0: reached, ")
    page.wait("page.state.goal.state === 'reached' && Math.abs(page.pose.x - 1) < 0.2")

    page.run(f"{BUTTON.replace('TEXT', 'Take over')}.click(); 0")
    page.wait("page.state.lease.client === page.drive.client")
    page.run("page.setMode('goal'); page.point({x: 0.2, y: 0, yaw: 0}); 0")
    page.wait("page.state.goal.state === 'driving' && page.state.goal.place[0] === 0.2")
    page.wait("page.state.goal.state === 'reached' && Math.abs(page.pose.x - 0.2) < 0.2")
    page.run("page.point({x: 1.5, y: 0, yaw: 0}); 0")
    page.wait("page.state.goal.state === 'driving' && page.pose.x > 0.3")
    page.run("document.getElementById('goal-cancel').click(); 0")
    page.wait("page.state.goal.state === 'stopped' && page.pose.speed < 0.02")
    assert float(page.run("page.pose.x")) < 1.3

    assert run.finish() == 0
    assert "warning: /keyboard_navigate" not in run.errors.read_text()
