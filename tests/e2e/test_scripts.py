"""Scripts and assistants as their users start them, on a simulated robot with either ROS."""

import asyncio
import json
import re
import subprocess
import sys
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.documents.test_examples import EXAMPLES, PRINTED
from tests.e2e.conftest import ROOT, end, make_environment

from ur.request.environment import current_selection

pytestmark = [pytest.mark.ros, pytest.mark.timeout(900)]

Results = dict[str, tuple[bool, str]]
"""Whether a tool or a resource was done, and its text, by its name."""

UR = str(ROOT / "ur")
PLOT = """
import sys, types

class Plot(types.ModuleType):
    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *_, **__: (print(name), (self, self))[1]

sys.modules["matplotlib"] = sys.modules["matplotlib.pyplot"] = plot = Plot("matplotlib")
plot.pyplot = plot
"""
"""A stand-in for matplotlib, which is no dependency of this project: prints what is called."""

TWO = r"(sim\S* (--ros 2 )?is at -?\d+\.\d\d -?\d+\.\d\d m\n){2}"
# A picture arrives in time, or not: of a base without a camera none, and on a busy computer one of two.
NO_CAMERA = r"table: (no picture: .*|table.jpeg, \d+ bytes)\ndoor: (no picture: .*|door.jpeg, \d+ bytes)\n"


@pytest.fixture
def navigating(tmp_path: Path, either_ros: dict[str, str]) -> Iterator[dict[str, str]]:
    """The environment of a robot that navigates, started as the page for authors of scripts says."""
    env = make_environment(tmp_path) | either_ros | {"XDG_STATE_HOME": str(tmp_path / "state")}
    with (tmp_path / "log").open("w") as log:
        robot = subprocess.Popen(
            [UR, "run", "keyboard_navigate"], env=env, stdin=subprocess.PIPE, stdout=log, stderr=log, cwd=tmp_path
        )
    try:
        run(env, tmp_path, "wait", "--timeout-ready", "90", attempts=60)
        yield env
    finally:
        end(robot)


def run(env: dict[str, str], folder: Path, *words: str, attempts: int = 1) -> str:
    """What a command of `ur` prints; again, for so many attempts, while it fails.

    A script that this computer keeps from running for 0.1 s loses its velocity, as it must: it has five attempts.
    """
    for attempt in range(max(attempts, 5)):
        done = subprocess.run([UR, *words], env=env, cwd=folder, capture_output=True, text=True, timeout=180)
        if done.returncode == 0 or (attempt + 1 >= attempts and "this program hung" not in done.stderr):
            break
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    return done.stdout


def test_scripts_and_all_calls_of_an_assistant_drive_a_robot(navigating: dict[str, str], tmp_path: Path) -> None:
    run_scripts(navigating, tmp_path)
    call_tools(navigating, tmp_path)


def run_scripts(navigating: dict[str, str], tmp_path: Path) -> None:
    """Run the first script of the page for authors, as it is typed there, and all examples."""
    page = (ROOT / "docs" / "how-to" / "write-a-script.md").read_text(encoding="utf-8")
    typed = re.findall(r"^ur ((?:new|run) \S*look_around\S*|new script \S+)$", page, re.MULTILINE)
    assert typed == ["new script look_around", "run look_around.py"]
    run(navigating, tmp_path, *typed[0].split())
    printed = run(navigating, tmp_path, *typed[1].split())
    place = r"the robot is at -?\d+\.\d\d -?\d+\.\d\d m"
    assert re.fullmatch(rf"{place}; .*\n{place}\n", printed), printed
    (tmp_path / "places.csv").write_text("0.4,0.0\n1000,1000\n")
    same = str(current_selection(navigating))  # one robot under two names, driven by the one program, then by the other
    for name, printed in {**PRINTED, "two_robots": TWO}.items():
        robots = (same, same.replace("sim", "sim.local")) if name == "two_robots" else ()
        found = run(navigating, tmp_path, "run", str(EXAMPLES / f"{name}.py"), *robots)
        assert re.fullmatch(f"{printed}|{NO_CAMERA}", found), f"{name}: {found}"
    cells = json.loads((EXAMPLES / "plot_scan.ipynb").read_text(encoding="utf-8"))["cells"]
    code = ["".join(each["source"]) for each in cells if each["cell_type"] == "code"]
    (tmp_path / "plot_scan.py").write_text("\n".join([PLOT, *code]))
    assert run(navigating, tmp_path, "run", "plot_scan.py").split() == ["subplots", "plot", "set_title", "savefig"]


def call_tools(navigating: dict[str, str], tmp_path: Path) -> None:
    """Run every tool and read every resource, by the SDK's client."""
    pytest.importorskip("mcp")
    folder = tmp_path / "elsewhere"  # tmp_path has a folder that is called as the package: for facts of nodes
    folder.mkdir()
    (folder / "a.launch").write_text('<launch><arg name="robot_base" default=""/></launch>\n')  # for `find`
    results = asyncio.run(call_over_stdio(navigating, folder))
    refused = {name: text for name, (done, text) in results.items() if not done}
    assert not refused, refused
    assert "driven" in results["drive"][1]
    assert "reached" in results["go_to"][1]
    assert "map" in results["explore"][1]
    assert "keyboard_navigate" in results["list"][1]


CALLS: dict[str, dict[str, object]] = {
    "look": {},
    "list": {},
    "check": {"paths": ["ubiquity_launches"]},
    "explain": {"package": "ubiquity_launches", "file": "m_move_base.launch.xml", "name": "robot_base"},
    "find": {"name": "robot_base"},
    "graph": {"package": "ubiquity_launches", "file": "m_move_base.launch.xml"},
    "doctor": {},
    "ask_to_drive": {"reason": "to try everything"},
    "drive": {"speed": 0.1, "seconds": 1.0},
    "go_to": {"x": 0.4, "y": 0.0},
    "explore": {"seconds": 20.0},
    "stop": {},
    "start_program": {"name": "local_costmap"},
    "end_program": {"name": "local_costmap"},
}


async def call_over_stdio(env: dict[str, str], folder: Path) -> Results:
    """Call everything through a server that the client starts; the grant is that of a terminal."""
    from mcp.client import Client
    from mcp.client.stdio import StdioServerParameters, stdio_client

    from ur.mcp.grants import grant_files, make_grant

    async def give(id: str) -> None:
        grant_files(env).give(id, make_grant(10.0, 0.2, (), (), programs=True))

    server = StdioServerParameters(command=UR, args=["mcp"], env=env, cwd=folder)
    # Its default is the standard error at the time of its import, which may be another test's.
    async with Client(stdio_client(server, errlog=sys.__stderr__ or sys.stderr)) as client:
        return await call_everything(client, env, give)


async def call_everything(client: Any, env: dict[str, str], give: Callable[[str], Awaitable[None]]) -> Results:
    """Call each tool, with a grant, and read each resource. Returns whether it was done, and the text."""
    from ur.mcp.grants import grant_files

    results: Results = {}
    tools = [each.name for each in (await client.list_tools()).tools]
    assert sorted(tools) == sorted(CALLS)
    await client.call_tool("look", {})
    (id,) = grant_files(env).list_servers()
    await give(id)
    for name, arguments in CALLS.items():
        answer = await client.call_tool(name, arguments)
        results[name] = not answer.is_error, "".join(getattr(each, "text", "") for each in answer.content)
    uris = [str(each.uri) for each in (await client.list_resources()).resources]
    uris += ["launch-plan://ubiquity_launches/m_move_base.launch.xml", "log://move_base"]
    for uri in uris:
        (found,) = (await client.read_resource(uri)).contents
        text = str(getattr(found, "text", "") or getattr(found, "blob", ""))
        results[uri] = text != "", text
    return results
