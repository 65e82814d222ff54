"""What is needed to build, how many compilers there is memory for, and a command that ends with whoever started it."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from ur.robot.deploy import build_attached
from ur.robot.deploy.build import FACTS, Builder, build_command, check_builder, choose_jobs, parse_builder
from ur.source import UserError

GOOD = Builder(frozenset({"catkin_make", "catkin", "cmake", "g++", "make"}), 4, 8000, 3)


def test_facts_are_those_of_the_computer(tmp_path: Path) -> None:
    for name in ("a", "b/c", ".hidden"):
        (tmp_path / "catkin_ws/src" / name).mkdir(parents=True)
        (tmp_path / "catkin_ws/src" / name / "package.xml").touch()
    done = subprocess.run(
        ["sh", "-c", FACTS], env={**os.environ, "HOME": str(tmp_path)}, capture_output=True, text=True, check=True
    )
    builder = parse_builder(done.stdout)
    assert builder.packages == 2
    assert builder.processors == len(os.sched_getaffinity(0))
    assert builder.memory > 0
    assert not builder.catkin_tools


def test_computer_without_a_workspace_has_no_packages() -> None:
    assert parse_builder("tool make\nprocessors 2\nmemory 2048\n") == Builder(frozenset({"make"}), 2, 2, None)


@pytest.mark.parametrize(
    ("processors", "memory", "wanted", "jobs", "said"),
    [
        (4, 8000, None, 4, ""),
        (4, 900, None, 1, "-j 1 on 4 processors"),  # a Raspberry Pi with 1 GB
        (4, 1700, None, 3, "-j 3 on 4 processors"),
        (1, 100, None, 1, ""),
        (4, 900, 4, 4, "warning: -j 4"),
        (4, 8000, 8, 8, ""),
    ],
)
def test_jobs_fit_into_memory(processors: int, memory: int, wanted: int | None, jobs: int, said: str) -> None:
    count, note = choose_jobs(replace(GOOD, processors=processors, memory=memory), wanted)
    assert count == jobs
    assert note.startswith(said)
    assert bool(note) == bool(said)


@pytest.mark.parametrize(
    ("builder", "said"),
    [
        (replace(GOOD, packages=None), "no workspace"),
        (replace(GOOD, packages=0), "holds no package"),
        (replace(GOOD, tools=frozenset({"cmake", "make"})), "catkin g++ not installed"),
        (replace(GOOD, tools=GOOD.tools - {"catkin"}, catkin_tools=True), "catkin-tools not installed"),
    ],
)
def test_what_is_missing_is_named(builder: Builder, said: str) -> None:
    with pytest.raises(UserError, match=said.replace("+", r"\+")):
        check_builder(builder, "bob", here=False)


def test_complete_computer_is_fine() -> None:
    check_builder(GOOD, "bob", here=False)


def test_workspace_is_built_with_what_it_was_made_with() -> None:
    assert "catkin_make -j2 --no-color --pkg a b" in build_command(GOOD, ["a", "b"], 2)
    assert "--pkg" not in build_command(GOOD, [], 2)
    line = build_command(replace(GOOD, catkin_tools=True), ["a"], 2)
    assert "catkin build" in line
    assert " a " in line


def start(line: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-I", build_attached.__file__, line],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def is_alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state not in ("Z", "X")


def wait_gone(pid: int) -> None:
    end = time.monotonic() + 60
    while is_alive(pid):
        assert time.monotonic() < end, f"{pid} still runs"
        time.sleep(0.02)


def test_exit_code_is_handed_on() -> None:
    with start("exit 7") as process:
        assert process.wait(60) == 7


@pytest.mark.parametrize("trap", ["", "trap '' TERM; "])  # what does not listen to one signal gets the next
def test_command_ends_with_its_input_and_so_does_what_it_started(trap: str) -> None:
    with start(f"{trap}sleep 600 & echo $!; wait; wait") as process:
        assert process.stdin
        assert process.stdout
        child = int(process.stdout.readline())
        assert is_alive(child)
        process.stdin.close()
        process.wait(60)
    wait_gone(child)


def test_command_ends_when_its_starter_is_ended() -> None:
    with start("sleep 600 & echo $!; wait") as process:
        assert process.stdout
        child = int(process.stdout.readline())
        process.send_signal(signal.SIGTERM)
        process.wait(60)
    wait_gone(child)


def test_what_a_command_leaves_behind_is_ended() -> None:
    with start("sleep 600 >/dev/null & echo $!; exit 3") as process:
        assert process.stdout
        child = int(process.stdout.readline())
        assert process.wait(60) == 3
    wait_gone(child)
