"""A robot with ROS 2 Jazzy, and a laptop without any ROS: the doctor, the set-up, driving."""

import json
from collections.abc import Iterator
from typing import Any

import pytest
from tests.hosts.bench import UR, Bench, Done, Machine, boot
from tests.hosts.bench.ros2_robot import DOMAIN, PREFIX, UNIT, install_jazzy, remove_ros1

# What the set-up must leave as it was; packages that it installs change what is left out, and add files elsewhere.
OURS = ("/home", "/opt", "/etc/ubiquity", "/etc/systemd", "/etc/udev", "/etc/sudoers", "/etc/ssh")
LEFT_OUT = r"/X11/app-defaults/|/(passwd|group|shadow|gshadow)|machine-id|/alternatives/|chrony|sudo_as_admin|\.cache/"
SNAPSHOT = (
    "find /etc /opt/robot /home/ros -path /etc/ssl -prune -o -type f ! -name '*-' ! -name ld.so.cache "
    f"-exec sha256sum {{}} + 2>/dev/null | grep -vE '{LEFT_OUT}' | sort -k 2"
)
SUDO = "{user} ALL=(ALL) NOPASSWD: ALL\n"


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    with boot(("laptop", "robot")) as bench:
        remove_ros1(bench["laptop"])
        install_jazzy(bench["robot"])
        for name, user in (("laptop", "pat"), ("robot", "ros")):
            bench[name].write(f"/etc/sudoers.d/{user}", SUDO.format(user=user), mode=0o440)
        yield bench


def findings(output: str) -> list[Any]:
    found: list[Any] = json.loads(output)["findings"]
    return found


def test_doctor_describes_a_robot_that_nothing_was_done_to(pair: Bench) -> None:
    """`ur doctor` logs in with the password, and needs nothing of this project there."""
    laptop = pair["laptop"]
    known = "mkdir -p -m 700 ~/.ssh; ssh-keyscan -t ed25519 robot.local 2>/dev/null >~/.ssh/known_hosts"
    laptop.wait_for(f"{known}; grep -q . ~/.ssh/known_hosts", user="pat", deadline=60)
    done = laptop.run(
        f"{UR} doctor robot -v --password-from 0",
        user="pat",
        stdin="ros\n",
        timeout=300,
        environment={"COLUMNS": "500"},
    )
    assert "Traceback" not in done.err
    assert "ROS 2 Jazzy in /opt/ros/jazzy" in done.out
    assert f"in domain {DOMAIN}, rmw_fastrtps_cpp ({UNIT})" in done.out
    assert "ros2-" not in done.out
    assert "missing-package" not in done.out
    assert PREFIX in done.out


def set_up(laptop: Machine, *options: str) -> Done:
    line = f"{UR} robot setup robot.local --name robot --base stage --no-programs --yes --passwords-from 0"
    return laptop.run(f"{line} {' '.join(options)}", user="pat", stdin="ros\n\n", timeout=600)


def test_set_up_changes_nothing_of_ros2_and_can_be_taken_back(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    before = robot.run(SNAPSHOT).out.splitlines()
    shown = set_up(laptop, "--dry-run").check()
    assert "ROS 2 Jazzy (domain 7; commands: /cmd_vel, Twist), which stays as it is" in shown.out
    assert robot.run("ls /etc/ubiquity /home/ros/ubiquity_launches 2>/dev/null").out == ""
    done = set_up(laptop).check()
    assert "ready after" in done.out
    assert robot.read("/etc/ubiquity/robot.yaml").splitlines()[1:] == [
        'name: "robot"',
        'base: "stage"',
        'ros: "jazzy"',
        f'ros_domain: "{DOMAIN}"',
        'ros_commands: "/cmd_vel"',
    ]
    assert robot.run(f"systemctl is-active {UNIT}").out == "active\n"
    assert robot.run("dpkg -l | grep -c python3-rospy").out == "0\n"
    assert "nothing to do" in set_up(laptop).check().out

    listed = laptop.wait_for(f"{UR} robots --json | grep jazzy", user="pat", deadline=60)
    assert '"ros": "jazzy"' in listed.out
    well = laptop.run(f"{UR} doctor robot --json", user="pat", timeout=300)
    assert [each["rule"] for each in findings(well.out) if each["rule"].startswith("ros2-")] == []

    undone = set_up(laptop, "--undo").check()
    assert "changes taken back" in undone.out
    after = robot.run(SNAPSHOT).out.splitlines()
    assert set(before) - set(after) == set()
    added = {line.split(maxsplit=1)[1] for line in set(after) - set(before)}  # by packages, which stay
    assert [each for each in sorted(added) if each.startswith(OURS)] == []
    assert robot.run(f"systemctl is-active {UNIT}").out == "active\n"


def test_planted_faults_of_real_nodes_are_named(pair: Bench) -> None:
    """A second base takes the other type in another domain; the first one gets no scan reader that it fits."""
    laptop, robot = pair["laptop"], pair["robot"]
    set_up(laptop).check()
    unit = robot.read(f"/etc/systemd/system/{UNIT}")
    robot.write("/etc/systemd/system/other.service", unit.replace(f"DOMAIN_ID={DOMAIN}", "DOMAIN_ID=0"))
    robot.run("systemctl daemon-reload && systemctl start other").check()
    done = laptop.run(f"{UR} doctor robot --json", user="pat", timeout=300)
    (found,) = [each for each in findings(done.out) if each["rule"].startswith("ros2-")]
    assert found["rule"] == "ros2-mixed-domains"
    assert "other.service is in domain 0" in found["message"]
    robot.run(found["commands"][0]["command"], user="ros", timeout=60).check()
    robot.wait_for("grep -q ready /run/base/log", deadline=60)
    after = laptop.run(f"{UR} doctor robot --json", user="pat", timeout=300)
    assert [each["rule"] for each in findings(after.out) if each["rule"].startswith("ros2-")] == ["ros2-same-name"]
    robot.run("systemctl stop other").check()
