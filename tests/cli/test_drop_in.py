"""`ur launch` in place of roslaunch: the same words beside the installed roslaunch, exit code for exit code."""

import io
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.forking import add_rosversion, python_of_ros, run_ur
from tests.run.conftest import RunWorld, master, world  # noqa: F401 - fixtures

from ur.cli.launch.options import OPTIONS
from ur.cli.launch.options import ROSLAUNCH as ROSLAUNCH_OPTIONS
from ur.cli.main import main

ROSLAUNCH = "/usr/bin/roslaunch"
FILES = {
    "good": '<param name="p" value="1"/><node pkg="little_nodes" type="quick" name="one" ns="deep" args="a \'b c\'"/>',
    "runs": '<node pkg="little_nodes" type="sleeper" name="one"/>',
    "bad": '<node pkg="little_nodes" type="quick" name="one">',
    "wrong": '<node pkg="little_nodes" name="one"/>',
    "needs": '<arg name="x"/><arg name="y" default="z" doc="what"/><node pkg="little_nodes" type="quick" name="one"/>',
    # The required node is the last: roslaunch fails when one ends while others are still to be started.
    "required": '<node pkg="little_nodes" type="sleeper" name="one"/>'
    '<node pkg="little_nodes" type="crash" name="two" required="true"/>',
    "required_well": '<node pkg="little_nodes" type="sleeper" name="one"/>'
    '<node pkg="little_nodes" type="quick" name="two" required="true"/>',
    "dies": '<node pkg="little_nodes" type="crash" name="one"/>',
    "again": '<node pkg="little_nodes" type="sleeper" name="one" respawn="true"/>',
}
# Words whose exit code and standard output are those of roslaunch; nothing is started.
QUESTIONS = (
    "--nodes good", "--nodes bad", "--nodes none.launch", "--nodes no_package none.launch", "--nodes wrong",
    "--files good", "--find-node /deep/one good", "--args /deep/one good", "--args=/deep/one good", "--args /no good",
    "--dump-params good", "--ros-args good", "--ros-args needs", "--ros-args bad", "--nodes --files good",
    "--nodes --find-node /deep/one good", "--nodes", "", "--wrong good", "-c child", "-c child good", "--core good",
    "-u http://localhost:1", "--no-sum --nodes good", "--skip-log-check --disable-title -v --local --nodes good",
    "-w nan good", "good x=3", "- -", "--port 11999 --nodes good", "-p 11999 -w 4 -t 3 --nodes good",
    "--master-logger-level debug --pid unused.pid --required --screen --nodes good",
    "--sigint-timeout 1 --sigterm-timeout 1 --log --wait --nodes good",
)  # fmt: skip
# Words that start something with a master that is there already; how it ends by itself.
RUNS = (
    "good", "bad", "none.launch", "needs x:=1", "required", "--required dies", "--required again",
    "-v --screen --local --no-summary --skip-log-check --disable-title --pid it.pid good",
    "--log --sigint-timeout 2 --sigterm-timeout 2 -p {port} -w 5 -t 2 --master-logger-level info good", "-",
)  # fmt: skip
# What ur launch says instead, and why: the named differences.
DIFFERENT = {
    "--find-node /no good": (0, 1),  # roslaunch prints an error and exits with 0
    "--dump good": (0, 2),  # --dump is an option of ours, no beginning of --dump-params
    "--sigint-timeout -1 good": (1, 2),  # found with the other options, before anything is done
    "-p nan good": (1, 2),  # likewise
}


Roslaunch = Callable[..., tuple[int, str, str]]


def words(text: str, folder: Path, port: int) -> list[str]:
    found = text.format(port=port).split()
    return [f"{folder}/{word}.launch" if word in FILES else word for word in found]


@pytest.fixture
def roslaunch() -> Roslaunch:
    """The installed roslaunch: its exit code, output and errors for the same words."""

    def answer(found: list[str], world: RunWorld, given: str = "") -> tuple[int, str, str]:  # noqa: F811 - likewise
        done = python_of_ros().run(
            ROSLAUNCH, *found, folder=world.folder, environment=world.environment, given=given.encode()
        )
        return done.returncode, done.stdout.decode(), done.stderr.decode()

    return answer


def run(words: list[str], world: RunWorld, given: str = "") -> tuple[int, str, str]:  # noqa: F811 - a fixture's value
    done = run_ur("launch", *words, folder=world.folder, environment=world.environment, given=given)
    return done.returncode, done.stdout, done.stderr


def write_files(world: RunWorld) -> None:  # noqa: F811 - likewise
    for name, body in FILES.items():
        world.write(body, f"{name}.launch")
    world.environment["PATH"] = f"{add_rosversion(world.folder)}:{os.environ['PATH']}"


def ur(*found: str) -> list[str]:
    return [sys.executable, "-m", "ur", "launch", *found]


@pytest.fixture
def ask(
    world: RunWorld,  # noqa: F811 - likewise
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> Callable[..., tuple[int, str, str]]:
    """`ur launch` in this process, for what starts nothing: its exit code, output and errors."""

    def answer(*found: str) -> tuple[int, str, str]:
        for name in os.environ.keys() - world.environment.keys():
            monkeypatch.delenv(name)
        for name, value in world.environment.items():
            monkeypatch.setenv(name, value)
        monkeypatch.chdir(world.folder)
        monkeypatch.setattr(sys, "stdin", io.StringIO())
        code = main(["launch", *found])
        return code, *capfd.readouterr()

    return answer


@pytest.mark.parametrize("text", QUESTIONS)
def test_question_is_answered_as_roslaunch_does(
    text: str,
    world: RunWorld,  # noqa: F811 - likewise
    ask: Callable[..., tuple[int, str, str]],
    roslaunch: Roslaunch,
) -> None:
    write_files(world)
    found = words(text, world.folder, world.port)
    expected, told, why = roslaunch(found, world)
    code, said, errors = ask(*found)
    assert code == expected, (errors, why)
    assert said == told
    assert code == 0 or errors.startswith(("error: ", f"{world.folder}", "bad", "wrong")), errors
    assert "Traceback" not in errors


@pytest.mark.parametrize("text", DIFFERENT)
def test_named_differences_are_as_named(
    text: str,
    world: RunWorld,  # noqa: F811 - likewise
    ask: Callable[..., tuple[int, str, str]],
    roslaunch: Roslaunch,
) -> None:
    write_files(world)
    found = words(text, world.folder, world.port)
    assert (roslaunch(found, world)[0], ask(*found)[0]) == DIFFERENT[text]


@pytest.mark.ros
@pytest.mark.parametrize("text", RUNS)
def test_run_ends_with_the_code_of_roslaunch(
    text: str,
    world: RunWorld,  # noqa: F811 - likewise
    master: int,  # noqa: F811 - likewise
    roslaunch: Roslaunch,
) -> None:
    write_files(world)
    found = words(text, world.folder, master)
    given = f"<launch>{FILES['required_well']}</launch>"
    expected, _, said = roslaunch(found, world, given)
    code, _, errors = run(found, world, given)
    assert code == expected, (errors, said)
    assert "Traceback" not in errors
    assert not (world.folder / "it.pid").exists()


@pytest.mark.ros
def test_run_that_is_interrupted_exits_as_roslaunch_does(world: RunWorld) -> None:  # noqa: F811 - a fixture
    write_files(world)
    text = "-p {port} --pid it.pid -w 4 -t 5 --master-logger-level error --sigint-timeout 1 runs"
    found = words(text, world.folder, world.port)
    assert interrupt([ROSLAUNCH, *found], world) == interrupt(ur(*found), world) == 0


@pytest.mark.ros
def test_core_alone_runs_until_it_is_interrupted(world: RunWorld) -> None:  # noqa: F811 - a fixture
    assert interrupt(ur("--core", "--pid", "it.pid"), world) == 0


def interrupt(command: list[str], world: RunWorld) -> int:  # noqa: F811 - a fixture's value
    """Start, wait for the last process that is to come, interrupt, wait for the end; return the exit code."""
    process = subprocess.Popen(
        command,
        env={**world.environment, "PYTHONUNBUFFERED": "1"},  # else roslaunch keeps its words to itself
        cwd=world.folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )
    try:
        assert process.stdout is not None
        read_until(process.stdout.fileno())
        if command[0] == ROSLAUNCH:
            wait_registered(world.folder)
        assert (world.folder / "it.pid").read_text() == str(process.pid)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
    finally:
        process.kill()
        process.wait()
    assert not (world.folder / "it.pid").exists()
    return process.returncode


def wait_registered(folder: Path) -> None:
    """Wait until roslaunch has started all nodes: interrupted before that it may wait 20 s for itself."""
    end = time.monotonic() + 60
    while not any("registrations completed" in path.read_text() for path in folder.rglob("roslaunch-*.log")):
        assert time.monotonic() < end, list(folder.rglob("*.log"))
        time.sleep(0.02)


def read_until(descriptor: int) -> None:
    """Wait until the last process that is to come is there: the node, or the master alone."""
    seen = b""
    end = time.monotonic() + 60
    while not (
        b"started with pid" in seen.partition(b"process[one")[2] or b"[/one] started" in seen or b"until Ctrl-C" in seen
    ):
        assert time.monotonic() < end, seen
        if select.select([descriptor], [], [], 1.0)[0]:
            data = os.read(descriptor, 65536)
            assert data, seen
            seen += data


@pytest.mark.ros
def test_wait_goes_on_once_a_master_is_there(world: RunWorld, master: int) -> None:  # noqa: F811 - a fixture
    # roslaunch 1.16 of Debian 12 does not come back from --wait, so that there is nothing to compare with.
    assert master
    write_files(world)
    code, _, errors = run(["--wait", f"{world.folder}/good.launch"], world)
    assert code == 0, errors


@pytest.mark.ros
def test_second_core_is_refused_as_by_roslaunch(
    world: RunWorld,  # noqa: F811 - a fixture
    master: int,  # noqa: F811 - a fixture
    roslaunch: Roslaunch,
) -> None:
    assert master
    code, _, errors = run(["--core"], world)
    assert code == roslaunch(["--core", "-p", str(master)], world)[0] == 1
    assert "a master runs already" in errors


def test_every_option_of_roslaunch_is_known(world: RunWorld, roslaunch: Roslaunch) -> None:  # noqa: F811 - likewise
    _, told, _ = roslaunch(["--help"], world)
    names = {
        word.strip(",").partition("=")[0]
        for line in told.splitlines()
        if line.startswith("  -")
        for word in line.split()[:4]
        if word.startswith("-")
    }
    assert len(names) > 25
    assert names - {"-h", "--help"} <= set(OPTIONS)
    assert {name for name in names if name.startswith("--")} == set(ROSLAUNCH_OPTIONS)
