"""A whole robot for a test: `ur launch` with a master of its own, and a client process to talk to it."""

import contextlib
import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.ros2_session import PYTHON as ROS2_PYTHON
from tests.ros2_session import free_domain
from tests.ros_session import Client, free_port

ROOT = Path(__file__).parents[2]
PYTHON = ROOT / ".venv" / "bin" / "python"


def make_environment(folder: Path) -> dict[str, str]:
    """An environment with a master address, home and logs of its own, and no display."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("ROS", "DISPLAY", "WAYLAND"))}
    home = folder / "home"
    home.mkdir(parents=True, exist_ok=True)
    return kept | {
        "HOME": str(home),
        "ROS_HOME": str(home / ".ros"),
        "ROS_MASTER_URI": f"http://localhost:{free_port()}",
        "ROS_HOSTNAME": "localhost",
        "ROS_PACKAGE_PATH": f"{ROOT / 'ubiquity_launches'}:/usr/share",
        "XDG_CONFIG_HOME": str(home / ".config"),
        "XDG_DATA_HOME": str(home / ".local"),
    }


@pytest.fixture(params=["1", "2"])
def either_ros(request: pytest.FixtureRequest, tmp_path: Path) -> dict[str, str]:
    """Select ROS 1 or ROS 2 for the environment that `make_environment` makes; what is to be set besides."""
    if request.param == "1":
        return {}
    if not ROS2_PYTHON.exists():
        pytest.skip("no wheels of ROS 2 for this processor")
    more = {"ROS_DOMAIN_ID": free_domain(), "XDG_RUNTIME_DIR": str(tmp_path)}
    command = [str(ROOT / "ur"), "use", "sim", "--ros", "2"]
    subprocess.run(command, env=make_environment(tmp_path) | more, capture_output=True, check=True)
    return more


class UrShell:
    """`ur` in an environment of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.environment = make_environment(folder)
        self.environment["PATH"] = f"{ROOT / 'ubiquity_launches' / 'bin'}:{os.environ['PATH']}"

    def ur(self, *words: str, keys: str = "") -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [str(ROOT / "ur"), *words],
            env=self.environment,
            cwd=self.folder,
            input=keys,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )


@pytest.fixture
def shell(tmp_path: Path) -> Iterator[UrShell]:
    made = UrShell(tmp_path)
    yield made
    assert made.ur("stop", "--all").returncode == 0


@pytest.fixture(params=["1", "2"])
def shell_of_either(request: pytest.FixtureRequest, shell: UrShell) -> UrShell:
    if request.param == "2":
        if not ROS2_PYTHON.exists():
            pytest.skip("no wheels of ROS 2 for this processor")
        shell.environment["ROS_DOMAIN_ID"] = free_domain()
        shell.environment["XDG_RUNTIME_DIR"] = str(shell.folder)
        assert shell.ur("use", "sim", "--ros", "2").returncode == 0
    return shell


def list_family(pid: int) -> list[int]:
    """A process and all below it."""
    import psutil

    try:
        parent = psutil.Process(pid)
        return [pid, *(child.pid for child in parent.children(recursive=True))]
    except psutil.NoSuchProcess:
        return []


def is_alive(pid: int) -> bool:
    """Whether a process runs: one that only waits to be reaped does not."""
    import psutil

    try:
        return bool(psutil.Process(pid).status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False


def end(process: subprocess.Popen[Any], seconds: float = 150.0) -> None:
    """Interrupt as Ctrl-C would, and insist if that does not help. Fails when something is left.

    What has ended and is not reaped yet is not left: that is for the first process of the computer to do.
    """
    family = list_family(process.pid)
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait(5)
    deadline = time.monotonic() + 60.0  # the guard of a run ends after it
    while (left := [pid for pid in family if is_alive(pid)]) and time.monotonic() < deadline:
        time.sleep(0.02)
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    assert not left, f"still running after the end: {left}"


class LaunchedRobot(Client):
    """The client's requests as calls: robot.ask("goal", x=1.0, y=2.0, seconds=30)."""

    def __init__(self, launch: subprocess.Popen[str], env: dict[str, str], log: Path) -> None:
        command = [str(PYTHON), "-m", "tests.e2e.client_node"]
        pipe, nowhere = subprocess.PIPE, subprocess.DEVNULL
        process = subprocess.Popen(command, cwd=ROOT, env=env, text=True, stdin=pipe, stdout=pipe, stderr=nowhere)
        super().__init__(process, limit=30.0)
        self.launch = launch
        self.env = env
        self.log = log

    def explain(self) -> str:
        return f"; launch log: {self.log.read_text()[-2000:]}"


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LaunchedRobot]:
    """A simulated stage robot in the maze that navigates, one for all tests of a module."""
    with start_robot(tmp_path_factory.mktemp("robot")) as robot:
        yield robot


@contextlib.contextmanager
def start_robot(folder: Path, *arguments: str) -> Iterator[LaunchedRobot]:
    """A simulated stage robot that navigates, started with these arguments of robot.launch besides."""
    env = make_environment(folder)
    log = folder / "launch.log"
    launch_file = str(Path(__file__).with_name("robot.launch"))
    command = [str(ROOT / "ur"), "launch", launch_file, "robot_base:=stage", *arguments]
    with log.open("w") as output:
        launch = subprocess.Popen(
            command, env=env, text=True, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT, cwd=folder
        )
    robot = LaunchedRobot(launch, env, log)
    try:
        robot.ask("ready", seconds=150)
        yield robot
    finally:
        robot.client.kill()
        robot.client.wait()
        end(launch)
