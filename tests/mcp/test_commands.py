"""An assistant names packages and names: no file outside of the workspaces, and at most two commands at once."""

import asyncio
import os
import subprocess
import sys
from pathlib import Path

import pytest

from ur.mcp import commands
from ur.mcp.commands import RefusedCommandError, check_word, run_command

SECRET = "hunter2"


@pytest.fixture(autouse=True)
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    folder = tmp_path / "ws"
    (folder / "mine").mkdir(parents=True)
    (tmp_path / "conf.yaml").write_text(f"password: {SECRET}\n")
    (folder / "mine/link").symlink_to(tmp_path / "conf.yaml")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(folder))
    monkeypatch.chdir(tmp_path)
    return folder


@pytest.mark.parametrize(
    "word",
    [
        "/proc/self/environ",
        "{above}/conf.yaml",
        "{workspace}/mine/link",
        "{workspace}/../conf.yaml",
        "..",
        "~/.ssh/config",
        "--fix",
        "a\nb",
        "$(env HOME)",
        "package://mine/a.yaml",
        "params_file:=/proc/self/environ",
        "params_file:=../conf.yaml",
        "params_file:=..",
        "params_file:=~/conf.yaml",
        "params_file:=$(env SECRET)",
        "params_file:=conf.yaml;id",
        "/proc/self/environ:=1/2",
        "--take-over:=yes",
        "",
    ],
)
def test_paths_outside_of_workspaces_and_values_that_are_paths_are_refused(word: str, workspace: Path) -> None:
    with pytest.raises(RefusedCommandError, match="expected a package"):
        check_word(word.format(workspace=workspace, above=workspace.parent))


@pytest.mark.parametrize(
    "word", ["mine", "n_motor_node.launch.xml", "/move_base/max_vel_x", "{workspace}/mine", "world:=office", "x:=-1.5"]
)
def test_packages_names_and_paths_in_workspaces_are_taken(word: str, workspace: Path) -> None:
    check_word(word.format(workspace=workspace))


async def test_names_of_files_are_those_of_the_project_not_of_the_folder_of_the_server() -> None:
    done, text = await run_command(("check",), ("conf.yaml",))
    assert not done
    assert SECRET not in text


async def test_third_command_at_once_is_refused() -> None:
    with commands._take_slot():
        with commands._take_slot(), pytest.raises(RefusedCommandError, match="2 commands of assistants run already"):
            await run_command(("list",))
        with commands._take_slot():
            pass


def test_command_has_limits_of_memory_and_time_and_yields_to_others() -> None:
    code = "import os, resource as r; print(*r.getrlimit(r.RLIMIT_AS), *r.getrlimit(r.RLIMIT_CPU), os.nice(0))"
    command = [*commands._LIMITS, sys.executable, "-I", "-c", code]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert text.split() == [str(1 << 30)] * 2 + ["60"] * 2 + [str(min(os.nice(0) + 10, 19))]


async def test_output_of_a_command_is_kept_within_a_limit() -> None:
    stream = asyncio.StreamReader()
    stream.feed_data(b"x" * 1_000_000)
    stream.feed_eof()
    assert len(await commands._read(stream)) == 240_000
