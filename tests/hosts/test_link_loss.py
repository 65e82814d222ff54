"""A program on two computers whose network is cut, whose robot restarts, and whose robot's nodes are ended there."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.hosts.bench import REPOSITORY, UR, Bench, Machine, boot
from tests.hosts.test_robot_setup import prepare, set_up
from tests.hosts.test_run_on_robot import PACKAGE, Started

LAUNCH = """\
<launch>
  <arg name="robot_machine" default="localhost"/>
  <arg name="viewer_machine" default="localhost"/>
  <machine name="localhost" address="localhost"/>
  <node machine="$(arg robot_machine)" name="talk" pkg="chat" type="talk.py"/>
  <node machine="$(arg viewer_machine)" name="hear" pkg="chat" type="hear.py" output="screen"/>
</launch>
"""
ONLY_THERE = """\
<launch>
  <arg name="robot_machine" default="localhost"/>
  <machine name="localhost" address="localhost"/>
  <node machine="$(arg robot_machine)" name="alone" pkg="chat" type="talk.py" output="screen"/>
</launch>
"""
TALK = f"""\
#!{REPOSITORY}/.venv/bin/python
import threading, time
import rospy
from std_msgs.msg import Int32
from ur_nodes.ros1.run import run_node

def start():
    out = rospy.Publisher("numbers", Int32, queue_size=1)
    def talk():
        number = 0
        while not rospy.is_shutdown():
            number += 1
            print("it says", number, flush=True)
            try:
                out.publish(number)
            except rospy.ROSException:
                return
            time.sleep(0.1)
    threading.Thread(target=talk, daemon=True).start()

run_node("talk", start)
"""
HEAR = f"""\
#!{REPOSITORY}/.venv/bin/python
import rospy
from std_msgs.msg import Int32
from ur_nodes.ros1.run import run_node

def start():
    rospy.Subscriber("numbers", Int32, lambda number: print("heard", number.data, flush=True))

run_node("hear", start)
"""
FILES = {
    "package.xml": (PACKAGE, 0o644),
    "launch/chat.launch": (LAUNCH, 0o644),
    "launch/alone.launch": (ONLY_THERE, 0o644),
    "scripts/talk.py": (TALK, 0o755),
    "scripts/hear.py": (HEAR, 0o755),
}
RECORDINGS = "/home/ros/.local/state/ur/recordings"
USERS = {"laptop": "pat", "robot": "ros"}


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    """A laptop, and a robot `bob` with a master from its start on; both have this project and the package `chat`."""
    with boot(("laptop", "robot"), with_repository=("laptop", "robot"), programs=True) as bench:
        laptop, robot = bench["laptop"], bench["robot"]
        prepare(laptop)
        set_up(laptop).check()
        robot.run(f"rm -rf ubiquity_launches && ln -s {REPOSITORY} ubiquity_launches", user="ros").check()
        for machine in (laptop, robot):
            user = USERS[machine.name]
            for name, (text, mode) in FILES.items():
                machine.write(f"/home/{user}/catkin_ws/src/chat/{name}", text, mode=mode)
            machine.run(f"chown -R {user}:{user} /home/{user}/catkin_ws/src/chat").check()
        laptop.run(f"{UR} use bob", user="pat").check()
        laptop.wait_for("rosnode list", user="pat", deadline=120)
        yield bench


@contextmanager
def started(pair: Bench, words: str, tmp_path: Path) -> Iterator[Started]:
    program = Started(pair["laptop"], words, tmp_path / "said")
    try:
        yield program
    finally:
        pair["laptop"].restore()
        if program.process.poll() is None:
            program.signal(signal.SIGKILL)
        program.process.wait(60)
        pair["robot"].run("bash -lc 'ur stop --all'", user="ros")


def reboot(robot: Machine) -> None:
    leader = robot.leader
    robot.run("systemctl --no-block reboot")
    robot.wait_rebooted(leader)


def test_lost_link_is_shown_and_topics_flow_again_after_it(pair: Bench, tmp_path: Path) -> None:
    with started(pair, "launch --plain chat chat.launch", tmp_path) as program:
        program.wait_said(r"heard \d+")
        pair["laptop"].cut()
        program.wait_said(r"no word from bob for 1\.\d s")
        program.wait_said(r"no word from bob for [4-8]\.\d s")
        pair["laptop"].restore()
        program.wait_said(r"bob answers again after \d+\.\d s")
        program.wait_said(r"heard \d+", after=program.said.index("answers again"))
        assert "died" not in program.said
        program.end()


def test_share_starts_again_after_a_reboot_of_the_robot(pair: Bench, tmp_path: Path) -> None:
    with started(pair, "launch --plain chat chat.launch", tmp_path) as program:
        program.wait_said(r"heard \d+")
        reboot(pair["robot"])
        program.wait_said(r"its nodes are started again", deadline=120)
        program.wait_said(r"heard \d+", after=program.said.index("are started again"), deadline=120)
        program.end()
        assert "has ended" in program.said


def test_followed_program_starts_again_after_a_reboot_of_the_robot(pair: Bench, tmp_path: Path) -> None:
    with started(pair, "launch --plain chat alone.launch", tmp_path) as program:
        program.wait_said(r"it says \d+")
        reboot(pair["robot"])
        program.wait_said(r"its nodes are started again", deadline=120)
        program.wait_said(r"it says \d+", after=program.said.index("are started again"), deadline=120)
        program.end()


def test_run_ends_with_a_command_when_the_robots_master_was_stopped(pair: Bench, tmp_path: Path) -> None:
    robot = pair["robot"]
    with started(pair, "launch --plain chat chat.launch", tmp_path) as program:
        program.wait_said(r"heard \d+")
        unit = robot.run("systemctl list-units --plain --no-legend 'ubiquity*master*' | cut -d' ' -f1").out.strip()
        assert unit
        robot.run(f"systemctl stop {unit}").check()
        try:
            assert program.process.wait(120) == 1, program.said
            assert "bob: its nodes were not started again: it has no ROS master" in program.said
            assert "start them again: ur launch" in program.said
        finally:
            robot.run(f"systemctl start {unit}").check()


def test_recording_on_the_robot_goes_on_without_the_laptop(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    robot.run("bash -lc 'ur launch --detach chat alone.launch'", user="ros").check()
    try:
        done = laptop.run(f"{UR} record /numbers", user="pat", timeout=120).check()
        assert "ur record --stop" in done.err
        robot.wait_for(f"ls {RECORDINGS}/*.mcap.part", user="ros", deadline=60)
        laptop.cut()
        size = f"stat -c %s {RECORDINGS}/*.mcap.part"
        before = int(robot.run(size, user="ros").check().out)
        robot.wait_for(f"[ $({size}) -gt {before} ]", user="ros", deadline=120)
        laptop.restore()
        stopped = laptop.run(f"{UR} record --stop", user="pat", timeout=120).check()
        (file,) = robot.run(f"ls {RECORDINGS}", user="ros").check().out.split()
        assert file.endswith(".mcap")
        assert f"{RECORDINGS}/{file}" in stopped.out
    finally:
        laptop.restore()
        robot.run("bash -lc 'ur stop --all'", user="ros")
