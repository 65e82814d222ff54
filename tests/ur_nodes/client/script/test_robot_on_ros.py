"""A program of a user's on ROS 1, beside a launched robot."""

import subprocess
import time
import xmlrpc.client
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from tests.e2e.conftest import ROOT, end, make_environment
from tests.ros_session import wait_for_port

pytestmark = pytest.mark.ros

LIBRARY = ROOT / "ubiquity_launches"
SCRIPT = """
from ur_nodes.client import Lost, Robot

with Robot() as robot:
    print(f"{len(robot.scan().ranges)} ranges")
    robot.drive(0.0, 0.5, 1.0)
    print("driven")
    try:
        robot.battery()
    except Lost as reason:
        print(reason)
"""


def run_script(folder: Path, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    script = folder / "script.py"
    script.write_text(SCRIPT, encoding="utf-8")
    command = [str(LIBRARY / "lib" / "node"), str(script)]
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=False)


def wait_for_topics(master: str, topics: set[str]) -> None:
    """Wait until all of them are published: a script itself waits for 10 s only."""
    deadline = time.monotonic() + 120.0
    with xmlrpc.client.ServerProxy(master) as server:
        published: set[str] = set()
        while not topics <= published:
            assert time.monotonic() < deadline, topics - published
            time.sleep(0.1)
            answer: Any = server.getPublishedTopics("/test", "")
            published = {name for name, _ in answer[2]}


@pytest.mark.timeout(300)
def test_script_drives_a_launched_robot_and_ends(tmp_path: Path) -> None:
    environment = make_environment(tmp_path)
    base = LIBRARY / "m_robot_base" / "launch" / "m_robot_base.launch.xml"
    with (tmp_path / "launch.log").open("w") as log:
        launch = subprocess.Popen(
            [str(ROOT / "ur"), "launch", str(base), "robot_base:=stage"],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            text=True,
        )
    try:
        wait_for_port(urlsplit(environment["ROS_MASTER_URI"]).port or 11311)
        wait_for_topics(environment["ROS_MASTER_URI"], {"/scan", "/cmd_vel_mux/challenge"})
        done = run_script(tmp_path, environment)
    finally:
        end(launch)
    assert done.returncode == 0, done.stderr
    ranges, driven, *_ = done.stdout.splitlines()
    assert ranges.endswith(" ranges")
    assert driven == "driven"


def test_script_without_a_master_says_what_is_missing(tmp_path: Path) -> None:
    done = run_script(tmp_path, make_environment(tmp_path))
    assert done.returncode != 0
    assert "no ROS master at http://" in done.stderr
