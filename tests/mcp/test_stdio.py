"""`ur mcp` over standard input and output: it starts at once or not at all, and ends in silence."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("mcp")

import click
from mcp.client import Client
from mcp.client.stdio import StdioServerParameters, stdio_client
from mcp.shared.exceptions import MCPError
from tests.mcp.robot import text_of
from tests.npm_packages import installed
from tests.ros_session import ROOT

from ur.cli.main import main
from ur.mcp.calls import EXAMPLES, TOOLS

Run = Callable[..., "subprocess.CompletedProcess[str]"]
INSPECTOR = "@modelcontextprotocol/inspector@0.15.0"


@pytest.fixture
def env(tmp_path: Path) -> dict[str, str]:
    return {**os.environ, "HOME": str(tmp_path), "ROS_HOME": str(tmp_path), "XDG_STATE_HOME": str(tmp_path / "state")}


@pytest.fixture
def bare(tmp_path: Path) -> Path:
    """The script `ur` in a clone that was never set up; its set-up fails with exit code 3."""
    clone = tmp_path / "a clone"
    (clone / "src/ur").mkdir(parents=True)
    (clone / "tools").mkdir()
    (clone / "tools/set_up.bash").write_text("exit 3\n")
    shutil.copy(ROOT / "ur", clone / "ur")
    return clone / "ur"


async def test_computer_that_was_never_set_up_names_the_command_that_installs(
    bare: Path, env: dict[str, str], tmp_path: Path
) -> None:
    with (tmp_path / "errors").open("w+") as errors:
        server = StdioServerParameters(command=str(bare), args=["mcp"], env=env)
        with pytest.raises(Exception, match="TaskGroup"):  # MCPError: connection closed, in groups
            async with Client(stdio_client(server, errlog=errors)):
                pass
        errors.seek(0)
        (line,) = errors.read().splitlines()
    assert line.startswith("error: what assistants need is not installed; install it first: ")
    command = line.partition("first: ")[2]
    assert subprocess.run([str(bare), "mcp"], env=env, capture_output=True, check=False).returncode == 2
    assert subprocess.run(["bash", "-c", command], env=env, check=False).returncode == 3, "it sets this computer up"


@pytest.fixture
def run_without(env: dict[str, str], tmp_path: Path) -> Run:
    """Run code in the system's Python with all packages of this environment but the SDK."""
    folder = tmp_path / "packages"
    folder.mkdir()
    for each in Path(click.__file__).parents[1].iterdir():
        if not each.name.startswith("mcp"):
            (folder / each.name).symlink_to(each)
    env["PYTHONPATH"] = f"{ROOT / 'src'}:{folder}"
    python = os.path.realpath(sys.executable)

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        command = [python, *words]
        return subprocess.run(command, env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)

    return run


def test_missing_python_packages_are_named_with_the_command_and_not_installed(run_without: Run) -> None:
    done = run_without("-m", "ur", "mcp")
    command = f"{ROOT / 'ur'} mcp --install"
    assert done.stderr == f"error: what assistants need is not installed; install it first: {command}\n"
    assert done.returncode == 2


def test_wheel_whose_environment_is_not_made_names_the_command(run_without: Run) -> None:
    done = run_without("-c", "import ur.installed, sys; sys.exit(ur.installed.enter_environment(['mcp']))")
    assert done.stderr == "error: what assistants need is not installed; install it first: ur mcp --install\n"
    assert done.returncode == 2


def test_setup_of_a_computer_includes_what_assistants_need(run_without: Run) -> None:
    done = run_without("-m", "ur", "setup", "--only-mine", "--dry-run")
    assert "Python packages: what assistants need" in done.stdout
    assert done.returncode == 0


def test_installation_that_is_there_already_is_reported(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mcp", "--install"]) == 0
    assert capsys.readouterr() == ("what assistants need is installed\n", "")


def test_end_of_a_client_that_closes_its_pipe_is_silent(env: dict[str, str], tmp_path: Path) -> None:
    client = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "a", "version": "1"}}
    pipe = subprocess.PIPE
    with subprocess.Popen([str(ROOT / "ur"), "mcp"], env=env, stdin=pipe, stdout=pipe, stderr=pipe) as server:
        assert server.stdin is not None
        assert server.stdout is not None
        assert server.stderr is not None
        server.stdin.write(_message("initialize", client, id=0))
        server.stdin.flush()
        assert b"ubiquity_launches" in server.stdout.readline()
        server.stdout.close()
        server.stdin.write(_message("notifications/initialized", {}))
        server.stdin.write(b"".join(_message("tools/list", {}, id=each) for each in range(1, 50)))
        server.stdin.close()
        assert server.stderr.read() == b""
    assert server.returncode == 0
    assert not list((tmp_path / "state").rglob("*crash*"))


async def test_examples_of_tools_are_answered_and_wrong_names_get_the_right_one(env: dict[str, str]) -> None:
    server = StdioServerParameters(command=str(ROOT / "ur"), args=["mcp"], env=env)
    async with Client(stdio_client(server, errlog=sys.__stderr__ or sys.stderr)) as client:
        for tool in (await client.list_tools()).tools:
            for example in tool.input_schema.get("examples", ()):
                result = await client.call_tool(tool.name, example)
                assert not result.is_error, text_of(result)
                assert "error: " not in text_of(result)
        for name, arguments, meant in WRONG:
            result = await client.call_tool(name, arguments)
            assert result.is_error
            assert text_of(result).endswith(f"did you mean {meant!r}?")
        with pytest.raises(MCPError, match=r"did you mean 'robot://pose'\?"):
            await client.read_resource("robot://poes")


WRONG: tuple[tuple[str, dict[str, Any], str], ...] = (
    ("drive", {"forward": 0.1}, "speed"),
    ("ask_to_drive", {"max_speed": 0.1}, "speed"),
    ("explain", {"file": "robot.launch", "parameter": "rate"}, "name"),
    ("check", {"path": "robot.launch"}, "paths"),
    ("find", {"names": "rate"}, "name"),
    ("graph", {"files": "robot.launch"}, "file"),
    ("ask_to_drvie", {}, "ask_to_drive"),
)


def test_named_arguments_have_types_and_the_same_speed() -> None:
    assert set(EXAMPLES) == {"check", "explain", "find", "graph"}
    for each in TOOLS.values():
        assert not each.verb or "arguments" not in each.arguments.__struct_fields__[:1]
    for name in ("drive", "ask_to_drive"):
        assert "speed" in TOOLS[name].arguments.__struct_fields__


def test_command_line_of_another_project_lists_the_tools(env: dict[str, str]) -> None:
    with installed("inspector", [INSPECTOR]) as folder:
        command = [str(folder / "node_modules/.bin/mcp-inspector"), "--cli", str(ROOT / "ur"), "mcp"]
        command += ["--method", "tools/list"]
        done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    assert {each["name"] for each in json.loads(done.stdout)["tools"]} == set(TOOLS)


def _message(method: str, params: dict[str, Any], **more: int) -> bytes:
    return json.dumps({"jsonrpc": "2.0", "method": method, "params": params, **more}).encode() + b"\n"
