"""Programs, nodes and findings on the page of `ur web`, in a real browser. No program runs when it is opened."""

import json
import re
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.chromium import Chromium, find_chromium
from tests.e2e.conftest import ROOT, end, make_environment
from tests.ros_session import free_port

PROGRAM = find_chromium()
PHONE, DESK = (390, 844), (1280, 800)
SETTLED = "globalThis.page?.status"

pytestmark = [
    pytest.mark.ros,
    pytest.mark.timeout(600),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
]
pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")


TALK = """\
<launch>
  <!--Summary: Prints lines.-->
  <arg name="word"/>
  <!--word: What it prints.-->
  <node name="talk" pkg="talk" type="talk_node" output="screen" args="$(arg word)"/>
</launch>
"""
NODE = """\
#!/bin/bash
echo "[INFO] [1.0]: <b>$1</b> from $$"
echo "[WARN] [1.0]: a warning"
echo "[ERROR] [1.0]: an error"
exec sleep 1000
"""


def make_package(folder: Path) -> Path:
    """A package with a program that prints lines of three severities."""
    package = folder / "packages" / "talk"
    files = {
        "package.xml": "<package><name>talk</name><version>1.0.0</version><description>t</description>"
        "<maintainer email='a@b.c'>a</maintainer><license>BSD</license></package>",
        "launch/talk.launch": TALK,
        "bin/ur_talk": '#!/bin/bash\n##Summary: Prints lines.\nexec ur launch talk talk.launch "$@"\n',
        "bin/talk_node": NODE,
    }
    for name, text in files.items():
        path = package / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)
    return package


class Site:
    """A server of `ur web` that can be killed and started again on its port, and what it started."""

    def __init__(self, folder: Path) -> None:
        self.env = make_environment(folder) | {"XDG_STATE_HOME": str(folder / "state")}
        self.env["ROS_PACKAGE_PATH"] += f":{make_package(folder)}"
        self.port, self.log = free_port(), folder / "web.log"
        self.start()

    def start(self) -> None:
        """Start the server, and wait for its link."""
        command = [str(ROOT / "ur"), "web", "--port", str(self.port), "--no-browser"]
        with self.log.open("w") as output:
            self.process = subprocess.Popen(
                command, env=self.env, stdin=subprocess.DEVNULL, stdout=output, stderr=output, text=True, cwd=ROOT
            )
        deadline = time.monotonic() + 60
        while "login#" not in self.log.read_text():
            assert self.process.poll() is None, self.log.read_text()
            assert time.monotonic() < deadline, "ur web printed no link"
            time.sleep(0.1)

    @property
    def link(self) -> str:
        found = re.search(r"http\S+", self.log.read_text())
        assert found
        return found[0]

    def ur(self, *words: str) -> str:
        command = [str(ROOT / "ur"), *words]
        done = subprocess.run(command, env=self.env, capture_output=True, text=True, timeout=120, cwd=ROOT, check=False)
        return done.stdout + done.stderr

    def ensure(self, program: str, *arguments: str) -> None:
        """Start a program unless it runs, as it does after the test that starts it on the page."""
        runs = [each["title"] for each in json.loads(self.ur("ps", "--json"))]
        if not any(program in title for title in runs):
            started = self.ur("run", program, "--detach", "--no-terminal", *arguments)
            assert "error" not in started, started


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    site = Site(tmp_path_factory.mktemp("site"))
    try:
        yield site
    finally:
        site.ur("stop", "--all")
        end(site.process)


@pytest.fixture(scope="module")
def browser(site: Site, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    assert PROGRAM is not None
    with Chromium(PROGRAM, tmp_path_factory.mktemp("chromium")) as browser:
        browser.resize(*DESK, phone=False)
        browser.open(site.link)
        yield browser


@pytest.fixture
def navigation(site: Site) -> None:
    """A robot that navigates."""
    site.ensure("keyboard_navigate", "world:=office")


@pytest.fixture
def both(site: Site) -> None:
    """A robot that navigates, and the program that prints lines, the younger of two runs."""
    site.ensure("keyboard_navigate", "world:=office")
    site.ensure("talk", "word:=cat<i>")


class ProgramsPage:
    """The page, by its elements."""

    def __init__(self, browser: Chromium) -> None:
        self.browser = browser

    def run(self, script: str) -> Any:
        return self.browser.run(script)

    def wait(self, script: str, seconds: float = 150.0) -> None:
        """Wait until an expression is true."""
        deadline = time.monotonic() + seconds
        while not self.browser.holds(script):
            shown = self.run("document.body?.innerText")
            assert time.monotonic() < deadline, f"{script}: not true within {seconds:g} s; the page: {shown}"
            time.sleep(0.1)

    def click(self, selector: str) -> None:
        self.wait(f"document.querySelector('{selector}')?.checkVisibility()")
        self.run(f"document.querySelector('{selector}').click(); 0")

    def open(self, panel: str) -> None:
        if not self.run(f"page.panels.isOpen('{panel}')"):
            self.run(f"page.panels.reveal('{panel}'); 0")
            self.click(f"#{panel}")


@pytest.fixture
def page(browser: Chromium) -> ProgramsPage:
    page = ProgramsPage(browser)
    page.wait(SETTLED)
    return page


def picture(page: ProgramsPage, folder: Path, name: str) -> None:
    for size in (PHONE, DESK):
        page.browser.resize(*size, phone=size == PHONE)
        (folder / f"{name}-{size[0]}.png").write_bytes(page.browser.screenshot())
        assert page.run("document.documentElement.scrollWidth") <= size[0]
        stop = "document.getElementById('stop')"
        assert page.run(
            f"(() => {{ const box = {stop}.getBoundingClientRect(); return {stop} === "
            "document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2); })()"
        ), "a panel covers the emergency stop"


def test_program_is_started_with_an_argument_and_its_nodes_are_seen(
    page: ProgramsPage, site: Site, tmp_path: Path
) -> None:
    page.wait("document.querySelector('.banner button')")  # nothing runs: the page offers the programs
    page.run("document.querySelector('.banner button').click(); 0")
    page.wait("document.querySelector('#program-keyboard_navigate summary')", 120)
    page.click("#program-keyboard_navigate summary")
    field = "document.getElementById('program-keyboard_navigate-world')"
    page.wait(f"{field}?.checkVisibility()")
    assert page.run(f"{field}.placeholder") == "maze"
    assert page.run(f"[...document.getElementById({field}.getAttribute('list')).options].map((e) => e.value)") == [
        "maze",
        "office",
    ]
    picture(page, tmp_path, "form")
    page.run(f"{field}.value = 'office'; 0")
    page.click("#program-keyboard_navigate .start")
    page.wait("page.panels.open === 'runs' && document.querySelector('tr[data-mood=up]')", 120)
    page.wait("[...document.querySelectorAll('#runs-panel tbody th')].some((e) => e.textContent === 'move_base')")
    page.wait("page.map.pose", 120)
    assert "m_keyboard_navigate" in site.ur("ps")
    (command,) = [line for line in site.ur("ps", "--json").splitlines() if '"pid"' in line]
    pid = re.search(r"\d+", command)
    assert pid
    assert b"world:=office" in Path(f"/proc/{pid[0]}/cmdline").read_bytes()


@pytest.mark.usefixtures("navigation")
def test_log_is_read_and_filtered_and_a_node_is_restarted(page: ProgramsPage, tmp_path: Path) -> None:
    page.open("programs")
    page.wait("document.getElementById('program-talk')")
    page.run("document.querySelector('.others').open = document.getElementById('program-talk').open = true; 0")
    page.wait("document.getElementById('program-talk-word')?.required")
    page.run("document.getElementById('program-talk-word').value = 'cat\\u003ci\\u003e'; 0")
    page.click("#program-talk .start")
    page.wait("page.panels.open === 'runs' && document.getElementById('log').innerText.includes('cat<i>')", 120)
    assert page.run("document.querySelectorAll('#log div b').length === document.querySelectorAll('#log > div').length")
    page.wait("document.querySelector('#log .warning') && document.querySelector('#log .error')")
    choose(page, "log-level", "3")
    page.wait("document.querySelectorAll('#log > div').length === 1")
    choose(page, "log-level", "1")
    row = "document.querySelector('#runs-panel tr[id$=\"/talk\"]')"
    before = page.run(node("/talk"))["pid"]
    page.run(f"{row}.querySelector('.restart').click(); 0")
    page.wait(f"{node('/talk')}?.state === 'running' && {node('/talk')}.pid !== {before}")
    page.wait(f"document.getElementById('log').innerText.includes('from ' + {node('/talk')}.pid)")
    page.run(f"{row}.querySelector('.stop').click(); 0")
    page.wait(f"{node('/talk')}.state === 'ended' && {row}.cells[1].textContent === 'stopped, restarted once'")
    page.run(f"{row}.querySelector('.stop').click(); 0")  # it says Start now
    page.wait(f"{node('/talk')}.state === 'running'")
    choose(page, "run", page.run("page.runs.state.runs[0].run"))
    page.wait("document.querySelector('#runs-panel tr[id$=\"/amcl\"]')?.dataset.mood === 'up'", 120)
    page.wait("/MB/.test(document.querySelector('#runs-panel tr[id$=\"/amcl\"]').cells[2].textContent)")
    picture(page, tmp_path, "nodes")
    choose(page, "run", page.run("page.runs.state.runs[1].run"))
    picture(page, tmp_path, "log")


def choose(page: ProgramsPage, field: str, value: str) -> None:
    event = "dispatchEvent(new Event('change'))"
    page.run(f"(() => {{ const e = document.getElementById('{field}'); e.value = '{value}'; e.{event}; }})()")


def node(name: str) -> str:
    return f"page.runs.state?.runs.flatMap((e) => e.nodes).find((e) => e.name === '{name}')"


@pytest.mark.usefixtures("both")
def test_page_shows_the_truth_after_the_server_was_killed(page: ProgramsPage, site: Site) -> None:
    page.open("runs")
    page.wait(f"{node('/amcl')}?.ready", 120)
    page.wait("document.getElementById('log').innerText.includes('an error')")
    kill(site)
    page.wait("!page.runs.state && document.querySelector('.banner')")
    site.ur("stop", "m_keyboard_navigate", "--node", "/amcl")  # it changes while nobody looks
    site.start()
    page.wait(f"{node('/amcl')}?.state === 'ended'")
    page.wait("page.server?.end === 'up' && page.poseAge < 1", 120)
    printed = site.ur("logs", "/talk", "--run", "talk").count("an error")  # as often as it was started
    assert printed
    page.wait("document.getElementById('log').innerText.includes('cat<i>')")  # read back, once
    assert page.run("document.getElementById('log').innerText.split('an error').length - 1") == printed
    choose(page, "run", page.run("page.runs.state.runs[0].run"))
    page.wait("document.querySelectorAll('#runs-panel tr[id$=\"/amcl\"]').length === 1")


def kill(site: Site) -> None:
    site.process.send_signal(signal.SIGKILL)
    site.process.wait(30)


def test_launch_file_is_drawn_and_each_node_is_explained(page: ProgramsPage, tmp_path: Path) -> None:
    page.open("programs")
    page.wait("document.getElementById('program-robot_base')")
    page.run("document.querySelector('.others').open = document.getElementById('program-robot_base').open = true; 0")
    page.click("#program-robot_base .row button:last-child")
    page.wait("document.querySelector('#program-robot_base img')?.naturalWidth > 100")
    page.wait("document.querySelector('#program-robot_base .launch li')")
    page.click("#program-robot_base .launch li button")
    page.wait("/n_\\w+\\.launch/.test(document.querySelector('#program-robot_base .launch pre').textContent)")
    picture(page, tmp_path, "launch")


def test_findings_of_the_doctor_are_shown_with_their_commands(page: ProgramsPage, tmp_path: Path) -> None:
    page.open("doctor")
    page.wait("/problem|All is well/.test(document.querySelector('#doctor-panel p').textContent)", 120)
    picture(page, tmp_path, "doctor")


def test_controls_of_panels_have_names(page: ProgramsPage) -> None:
    for panel in ("programs", "runs", "doctor"):
        page.open(panel)
        tree = page.browser.ask("Accessibility.getFullAXTree")["nodes"]
        roles = ("button", "combobox", "textbox", "checkbox", "image", "table")
        nameless = [
            each["role"]["value"]
            for each in tree
            if each.get("role", {}).get("value") in roles and not each.get("name", {}).get("value")
        ]
        assert nameless == [], panel


@pytest.mark.usefixtures("both")
def test_run_is_ended_after_a_second_press(page: ProgramsPage, site: Site) -> None:
    page.open("runs")
    page.wait("page.runs.state?.runs.length === 2")
    for left in (1, 0):
        page.click("#run-end")
        page.click("#run-end")
        page.wait(f"page.runs.state.runs.length === {left} && page.runs.state.ended.length")
    assert "no run is active" in site.ur("ps")
    page.wait("document.querySelector('#runs-panel summary')?.textContent.includes('asked by the page')")
