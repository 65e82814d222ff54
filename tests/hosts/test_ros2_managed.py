"""A robot with ROS 2 in a namespace, and a laptop without any ROS: what works with ROS 1 works there, too."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.hosts.bench import REPOSITORY, UR, Bench, Done, boot, wait_until
from tests.hosts.bench.ros2_robot import DOMAIN, UNIT, install_jazzy, remove_ros1
from tests.hosts.managed import PROFILE, SETTINGS, TAKE_OVER, wait_reached, wait_settled, wait_up
from tests.hosts.test_ros2_driving import key_held, last_motion, program
from tests.hosts.test_ros2_robot import SUDO, set_up
from tests.hosts.test_wifi_change import PRETENDER, WIFI_PASSWORD
from tests.hosts.test_x import SCREEN, XVFB, started

pytestmark = [pytest.mark.timeout(900)]
NAMESPACE = "/robot1"
MEMORY = "ls /dev/shm | grep fastrtps_"


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    """Both have this project; the network of the robot belongs to NetworkManager."""
    with boot(("laptop", "robot"), with_repository=("laptop", "robot")) as bench:
        laptop, robot = bench["laptop"], bench["robot"]
        remove_ros1(laptop)
        install_jazzy(robot, "--ros-args", "-r", f"__ns:={NAMESPACE}")
        for name, user in (("laptop", "pat"), ("robot", "ros")):
            bench[name].write(f"/etc/sudoers.d/{user}", SUDO.format(user=user), mode=0o440)
        robot.run("rm /var/lib/systemd/linger/ros").check()
        robot.run(f"ln -s {REPOSITORY} ubiquity_launches", user="ros").check()
        # With the end of that login systemd removes the memory of the base, which then receives from no new node.
        robot.wait_for(f"! {MEMORY}", deadline=120)
        done = set_up(laptop).check()
        assert f"restart of {UNIT}, whose shared memory a logout has removed" in done.out
        laptop.run(f"{UR} use robot", user="pat").check()
        profile = PROFILE.format(address=robot.address)
        robot.write("/etc/NetworkManager/system-connections/wired.nmconnection", profile, mode=0o600)
        robot.write("/etc/NetworkManager/conf.d/bench.conf", SETTINGS)
        robot.write("/usr/local/bin/nmcli", PRETENDER, mode=0o755)
        robot.run(TAKE_OVER).check()
        wait_up(robot)
        wait_reached(laptop, "robot")
        yield bench


def ur(pair: Bench, words: str, *lines: str) -> Done:
    given = "".join(f"{line}\n" for line in lines)
    return pair["laptop"].run(f"{UR} {words}", user="pat", stdin=given, timeout=300)


def test_set_up_finds_the_namespace_and_selects_the_robot(pair: Bench) -> None:
    assert pair["robot"].read("/etc/ubiquity/robot.yaml").splitlines()[1:] == [
        'name: "robot"',
        'base: "stage"',
        'ros: "jazzy"',
        f'ros_domain: "{DOMAIN}"',
        f'ros_namespace: "{NAMESPACE}"',
        f'ros_commands: "{NAMESPACE}/cmd_vel"',
    ]
    assert pair["robot"].read("/var/lib/systemd/linger/ros") == ""
    assert ur(pair, "use").check().out == "robot\n"
    assert pair["laptop"].run(f'eval "$({UR} env)" && echo "$UR_SELECTION"', user="pat").check().out == "robot\n"


def test_shared_memory_of_the_base_outlives_logouts(pair: Bench) -> None:
    robot = pair["robot"]
    before = robot.run(MEMORY).check().out
    ur(pair, "shell robot true").check()
    robot.wait_for('[ "$(loginctl show-user ros -p State --value)" = lingering ]', deadline=60)
    assert robot.run(MEMORY).out == before


def test_keys_drive_the_base_in_its_namespace(pair: Bench, tmp_path: Path) -> None:
    with program(pair["laptop"], "run keyboard_drive obstacle_stop:=false", tmp_path) as terminal:
        terminal.until("hold a key", 120.0)
        begin = time.monotonic()
        with key_held(terminal, "i"):
            wait_until(lambda: last_motion(pair["robot"]) > begin, "the base moves", 30.0)


def test_shell_and_windows_of_the_robot_are_those_of_its_user(pair: Bench) -> None:
    assert ur(pair, "shell robot 'id -un'").check().out == "ros\n"
    with started(pair["laptop"], XVFB, "pat"):
        pair["laptop"].wait_for("[ -S /tmp/.X11-unix/X7 ]", deadline=60)
        done = pair["laptop"].run(f"{UR} shell -X --check robot", user="pat", environment=SCREEN, timeout=120).check()
    assert "opened" in done.out


def test_workspaces_are_synchronised(pair: Bench) -> None:
    pair["laptop"].run("mkdir -p catkin_ws/src/p && echo 1 >catkin_ws/src/p/a.launch", user="pat").check()
    ur(pair, "sync robot --yes").check()
    assert pair["robot"].run("cat catkin_ws/src/p/a.launch", user="ros").check().out == "1\n"
    assert ur(pair, "sync robot --yes").check().out == "in step with robot\n"


def test_robot_joins_a_wireless_network(pair: Bench) -> None:
    done = ur(pair, "robot wifi robot --ssid Lab --passwords-from 0", WIFI_PASSWORD, "ros")
    assert done.code == 0, done.err
    wait_settled(pair["robot"])
    assert "Lab" in pair["robot"].run("nmcli -t -f NAME connection show").out


def test_robot_gets_another_name_and_keeps_its_ros2(pair: Bench) -> None:
    before = pair["robot"].read("/etc/ubiquity/robot.yaml")
    ur(pair, "robot rename robot eve --password-from 0", "ros").check()
    wait_settled(pair["robot"])
    wait_reached(pair["laptop"], "eve")
    assert pair["robot"].read("/etc/ubiquity/robot.yaml") == before.replace('"robot"', '"eve"')
    assert ur(pair, "use").check().out == "eve\n"
    found = pair["laptop"].wait_for(f"{UR} robots --json | grep -A 12 eve", user="pat", deadline=60)
    assert '"ros": "jazzy"' in found.out
    ur(pair, "robot rename eve robot --password-from 0", "ros").check()
    wait_settled(pair["robot"])
    wait_reached(pair["laptop"], "robot")
