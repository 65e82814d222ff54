"""A robot that runs says what it is: over a real master, to a launch file that somebody starts elsewhere."""

import subprocess
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest
import yaml
from tests.forking import run_ur
from tests.ros_session import ROOT, RosSession

from ur.request.bases.robot_facts import read_facts
from ur.robot.boot.units import set_base_script

pytestmark = [pytest.mark.ros, pytest.mark.timeout(200)]

VIEWER = """<launch>
  <arg name="robot_base"/>
  <arg name="robot_variant" default=""/>
  <arg name="robot_machine" default="nowhere"/>
  <arg name="viewer_machine" default="nowhere"/>
  <param name="seen" value="$(arg robot_base) $(arg robot_variant) $(arg robot_machine) $(arg viewer_machine)"/>
</launch>
"""


@pytest.fixture
def session(tmp_path: Path) -> Iterator[RosSession]:
    session = RosSession(tmp_path)
    session.env |= {"HOME": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path / "config")}
    try:
        yield session
    finally:
        session.close()


def boot_robot(session: RosSession, folder: Path, text: str) -> None:
    """What the unit of a robot's master runs once the master is up."""
    path = folder / "robot.yaml"
    path.write_text(text, encoding="utf-8")
    command = ["/usr/bin/python3", "-c", set_base_script(path)]
    subprocess.run(command, env=session.env, check=True, timeout=90)


def ask_viewer(session: RosSession, folder: Path, *words: str) -> tuple[str, str]:
    """What a viewer's launch file is given, and what is said on standard error."""
    path = folder / "viewer.launch"
    path.write_text(VIEWER, encoding="utf-8")
    done = run_ur("launch", "--dump-params", str(path), *words, folder=ROOT, environment=session.env)
    assert done.returncode == 0, done.stderr
    values: Mapping[str, str] = yaml.safe_load(done.stdout)
    return values["/seen"], done.stderr


def test_viewer_takes_base_and_variant_from_the_robots_parameter_server(session: RosSession, tmp_path: Path) -> None:
    boot_robot(session, tmp_path, "name: bob\nbase: magni\nvariant: lidar\n")
    assert read_facts(session.env["ROS_MASTER_URI"]) == ("magni", "lidar")
    seen, said = ask_viewer(session, tmp_path)
    assert seen == "magni lidar localhost localhost"
    assert said == "the robot that runs already is a magni: the selection sim:stage is not used\n"


def test_base_that_is_given_by_hand_counts(session: RosSession, tmp_path: Path) -> None:
    boot_robot(session, tmp_path, "name: bob\nbase: magni\n")
    assert ask_viewer(session, tmp_path, "robot_base:=loki") == ("loki  localhost localhost", "")


def test_robot_that_says_nothing_is_taken_for_the_selected_one(session: RosSession, tmp_path: Path) -> None:
    assert ask_viewer(session, tmp_path) == ("stage  localhost localhost", "")
