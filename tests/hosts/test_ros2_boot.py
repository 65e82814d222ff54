"""Boot services of a robot with ROS 2: programs among its nodes, and the mux between all programs and its base."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.hosts.bench import REPOSITORY, UR, Bench, Done, Machine, boot, wait_until
from tests.hosts.bench.ros2_robot import DOMAIN, PREFIX, UNIT, install_jazzy, remove_ros1
from tests.hosts.managed import wait_reached
from tests.hosts.test_ros2_driving import commands, key_held, last_motion, program
from tests.hosts.test_ros2_robot import SNAPSHOT, SUDO, set_up

pytestmark = [pytest.mark.timeout(900)]
MUX = "ubiquity-cmd_vel_mux.service"
FILES = f"{SNAPSHOT} | grep -v ' /home/'"
LIMIT = 2.0  # m/s: more than the base is allowed, and less than the program asks for
# Not robot_base: its robot_state_publisher needs tf2_msgs, which Jazzy has and its wheels do not.
MUX_ARGUMENTS = "ubiquity_launches n_cmd_vel_mux.launch.xml obstacle_stop:=false"
PUBLISHER = """\
import rclpy
from geometry_msgs.msg import Twist
rclpy.init()
node = rclpy.create_node("program")
publisher = node.create_publisher(Twist, "/robot1/cmd_vel", 10)
message = Twist()
message.linear.x = 5.0
node.create_timer(0.1, lambda: publisher.publish(message))
rclpy.spin(node)
"""


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    with boot(("laptop", "robot"), with_repository=("laptop", "robot")) as bench:
        laptop, robot = bench["laptop"], bench["robot"]
        remove_ros1(laptop)
        install_jazzy(robot, "--ros-args", "-r", "__ns:=/robot1")
        for name, user in (("laptop", "pat"), ("robot", "ros")):
            bench[name].write(f"/etc/sudoers.d/{user}", SUDO.format(user=user), mode=0o440)
        robot.run(f"ln -s {REPOSITORY} ubiquity_launches", user="ros").check()
        robot.write("/opt/robot/program.py", PUBLISHER)
        yield bench


def ur(pair: Bench, words: str) -> Done:
    return pair["laptop"].run(f"{UR} {words}", user="pat", timeout=300)


def publish(robot: Machine) -> None:
    """Run a program of others, which publishes what the base took before, until the base moves."""
    begin = time.monotonic()
    robot.run(
        f"systemd-run --unit program --uid ros bash -c '. {PREFIX}/setup.bash; ROS_DOMAIN_ID={DOMAIN} "
        "exec python3 /opt/robot/program.py'"
    ).check()
    try:
        wait_until(lambda: last_motion(robot) > begin, "the base moves", 60.0)
    finally:
        robot.run("systemctl kill -s KILL program; systemctl reset-failed program")


def test_programs_of_others_drive_through_the_mux_and_stop_with_it(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    set_up(laptop).check()
    before = robot.run(FILES).out
    done = set_up(laptop, "--take-over").check()
    assert f"remap of {UNIT}" in done.out
    assert "the mux alone reaches the base; it takes over /robot1/cmd_vel (Twist)" in done.out
    assert 'ros_commands: "/robot1/cmd_vel_base"' in robot.read("/etc/ubiquity/robot.yaml")
    assert robot.run(f"systemctl is-active {UNIT}").out == "active\n"
    robot.wait_for(f"systemctl is-active {MUX}", deadline=60)
    publish(robot)
    wait_until(lambda: commands(robot)[-1][1:] == (0.0, 0.0), "the base is at rest", 5.0)
    assert 0.0 < max(ahead for _, ahead, _ in commands(robot)) < LIMIT
    assert "nothing to do" in set_up(laptop, "--take-over").check().out
    assert "nothing to do" in set_up(laptop).check().out

    done = set_up(laptop, "--undo").check()
    assert f"remap of {UNIT}: taken back" in done.out
    assert robot.run(f"systemctl is-active {MUX}").out == "inactive\n"
    set_up(laptop).check()
    assert robot.run(FILES).out == before


def test_base_without_a_unit_is_named_and_left_as_it_is(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    unit = robot.read(f"/etc/systemd/system/{UNIT}")
    script = f"#!/bin/bash\n. {PREFIX}/setup.bash\npython3 /opt/robot/cmd_vel_base.py --ros-args -r __ns:=/robot1\n"
    robot.write("/opt/robot/start", script, mode=0o755)
    start = next(line for line in unit.splitlines() if line.startswith("ExecStart="))
    robot.write(f"/etc/systemd/system/{UNIT}", unit.replace(start, "ExecStart=/opt/robot/start"))
    robot.run(f"systemctl daemon-reload && systemctl restart {UNIT}").check()
    robot.wait_for("tail -n 1 /run/base/log | grep -q ready", deadline=60)
    done = set_up(laptop, "--take-over").check()
    assert f"ExecStart= of {UNIT} shows neither its node nor a launch file" in done.out
    assert "programs can reach the base past the mux" in done.out


def test_program_runs_after_a_reboot_among_the_nodes_of_the_robot(pair: Bench, tmp_path: Path) -> None:
    robot = pair["robot"]
    set_up(pair["laptop"]).check()
    ur(pair, "use robot").check()
    nothing = ur(pair, "boot install")
    assert (nothing.code, "has ROS 2, which needs no master" in nothing.err) == (2, True)
    ur(pair, f"boot install {MUX_ARGUMENTS}").check()
    assert "nothing to do" in ur(pair, f"boot install {MUX_ARGUMENTS}").check().out
    leader = robot.leader
    robot.run("systemctl reboot")
    robot.wait_rebooted(leader, deadline=180)
    wait_reached(pair["laptop"], "robot")
    pair["laptop"].wait_for(f"{UR} boot status | grep -q 'n_cmd_vel_mux: runs'", user="pat", deadline=60)
    assert robot.run("ls /etc/systemd/system/ubiquity-master.service").code != 0
    robot.wait_for("grep -q ready /run/base/log", deadline=60)
    with program(pair["laptop"], "run keyboard_drive", tmp_path) as terminal:
        terminal.until("hold a key", 120.0)
        begin = time.monotonic()
        with key_held(terminal, "i"):
            wait_until(lambda: last_motion(robot) > begin, "the base moves", 30.0)
    assert "ubiquity-n_cmd_vel_mux.service: removed" in ur(pair, "boot remove").check().out
    assert robot.run(f"systemctl is-active {UNIT}").out == "active\n"
