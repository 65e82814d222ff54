"""`ur doctor` on a pair that was set up: silent on a healthy one; planted faults are named and fixed by its advice.

A fault is fixed either by `--fix` or by the commands that stand with the finding, typed as they are printed.
"""

import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from tests.hosts.bench import UR, Bench, Done, boot, wait_until
from tests.hosts.test_robot_setup import PASSWORD, prepare, running, set_up

ON = {"local": ("laptop", "pat"), "remote": ("robot", "ros")}
SECONDS = 120.0
BLOCK = (
    "nft add table ip test && nft add chain ip test in '{ type filter hook input priority 0; }' && "
    "nft add rule ip test in tcp dport 1024-65535 tcp flags '&' '(syn|ack)' == syn drop"
)
STALE = """\
ssh-keygen -q -t ed25519 -N '' -f /root/stale <<<y >/dev/null
sed -i '/^{name}.local/d' {home}/.ssh/known_hosts
echo "{name}.local,{name} $(cut -d' ' -f1,2 /root/stale.pub)" >>{home}/.ssh/known_hosts
"""
# A home on a disk of its own, of 60 MB, that the logs of ROS fill to the last byte.
FULL = """\
set -e
mount -t tmpfs -o size=60m,mode=755 tmpfs /mnt
cp -a /home/ros/. /mnt/; chown ros:ros /mnt; mount --bind /mnt /home/ros
su ros -c 'mkdir -p ~/.ros/log/old; head -c 70000000 /dev/zero >~/.ros/log/old/rosout.log' 2>/dev/null || true
"""
# See other_clock.c: chrony can set this clock, and takes it for the computer's.
OTHER_CLOCK = """\
set -e
gcc -shared -fPIC -O1 -o /usr/local/lib/other_clock.so /root/other_clock.c
python3 -c "import struct; open('/run/other-clock', 'wb').write(struct.pack('q', 5 * 10**9))"
printf '[Service]\\nExecStart=\\nExecStart=/usr/sbin/chronyd -d -u root -F 0\\n' \\
  >/etc/systemd/system/chrony.service.d/other.conf
systemctl daemon-reload
echo /usr/local/lib/other_clock.so >/etc/ld.so.preload
"""
OWN_CLOCK = """\
rm -f /etc/ld.so.preload /etc/systemd/system/chrony.service.d/other.conf
systemctl daemon-reload && systemctl restart chrony
"""
MESSAGE = (
    "mkdir -p catkin_ws/src/my_msgs/msg && echo '<package/>' >catkin_ws/src/my_msgs/package.xml && "
    "echo '{type} speed # of a wheel' >catkin_ws/src/my_msgs/msg/Wheel.msg"
)
FAILING = "sh -c 'echo the motor is missing; exit 3'"


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    with boot(("laptop", "robot")) as bench:
        prepare(bench["laptop"])
        set_up(bench["laptop"]).check()
        bench["robot"].write("/etc/sudoers.d/ros", "ros ALL=(ALL) NOPASSWD: ALL\n", mode=0o440)
        yield bench


Row = tuple[str, str, str]


@pytest.fixture(scope="module")
def table(pair: Bench) -> Iterator[list[Row]]:
    """What became of each fault, printed at the end. The doctor has seen the robot before anything was wrong."""
    examine(pair).check()
    rows: list[Row] = []
    yield rows
    for row in rows:
        sys.stdout.write("\n{:36} {:24} {}".format(*row))
    sys.stdout.write(f"\n{len(rows)} faults named and fixed\n")


def examine(pair: Bench, *options: str) -> Done:
    line = f"{UR} doctor bob --password-from 0 {' '.join(options)}"
    return pair["laptop"].run(line, user="pat", stdin=f"{PASSWORD}\n", timeout=300)


def find(pair: Bench) -> list[Any]:
    found: list[Any] = json.loads(examine(pair, "--json").out)["findings"]
    return found


def name(pair: Bench, rule: str) -> Any:
    """The finding that names a fault, once it shows."""
    found: list[Any] = []

    def is_named() -> bool:
        found[:] = find(pair)
        return [finding["rule"] for finding in found].count(rule) == 1

    try:
        wait_until(is_named, f"{rule} is found", SECONDS)
    except AssertionError as problem:
        raise AssertionError(f"{problem}: {found}") from None
    return next(finding for finding in found if finding["rule"] == rule)


def carry_out(pair: Bench, finding: Any, *, added: str = "", stdin: str = "") -> str:
    """Type the commands that stand with a finding, each where it says; `added` to the last. What was typed."""
    assert finding["commands"], finding
    for command in finding["commands"]:
        machine, user = ON[command["where"]]
        pair[machine].run(command["command"] + added, user=user, stdin=stdin, timeout=400).check()
    return " && ".join(f"{command['on']}$ {command['command']}" for command in finding["commands"])


def wait_until_well(pair: Bench) -> None:
    """Until nothing is found: names and addresses that changed need a moment."""
    last: list[Any] = []

    def is_well() -> bool:
        last[:] = find(pair)
        return not last

    try:
        wait_until(is_well, "all is well", SECONDS)
    except AssertionError as problem:
        raise AssertionError(f"{problem}: {last}") from None


@dataclass(frozen=True)
class Fault:
    """A fault: how it is planted (by root) on which computer, the finding that names it, and what is tidied away after.

    `fix`: --fix fixes it; otherwise the commands of the finding do, after what happened `meanwhile`.
    """

    title: str
    rule: str
    plant: str
    fix: bool = True
    machine: str = "robot"
    tidy: str = "true"
    meanwhile: str = "true"


FAULTS = (
    Fault("wrong ROS_IP", "wrong-ros-ip", "printf 'unset ROS_HOSTNAME\\nexport ROS_IP=192.0.2.1\\n' >>~ros/.ros_setup"),
    Fault(
        "wrong ROS_HOSTNAME in terminals",
        "wrong-ros-hostname",
        "echo 'export ROS_HOSTNAME=robot' >>~ros/.bashrc",
        fix=False,
    ),
    Fault("wrong master", "wrong-master", "echo 'export ROS_MASTER_URI=http://elsewhere:11311' >>~ros/.ros_setup"),
    Fault("clock 5 s off", "clock-offset", OTHER_CLOCK, tidy=OWN_CLOCK),
    Fault("no time synchronisation", "no-time-synchronisation", "systemctl disable --now chrony"),
    Fault("missing key (this computer's)", "key-refused", "mv ~ros/.ssh/authorized_keys /root/"),
    Fault("missing key (the robot's)", "no-login-there", "rm ~ros/.ssh/id_ed25519*"),
    Fault("wrong permission", "loose-rights", "chmod 777 ~ros/.ssh"),
    Fault("closed port", "closed-port", BLOCK, fix=False, tidy="nft delete table ip test"),
    Fault("stale known_hosts (the robot's)", "unknown-host-key-there", STALE.format(name="laptop", home="/home/ros")),
    Fault(
        "stale known_hosts (ours)",
        "changed-host-key",
        STALE.format(name="bob", home="/home/pat"),
        fix=False,
        machine="laptop",
    ),
    Fault("full disk", "full-disk", FULL, fix=False, tidy="umount -l /home/ros; umount -l /mnt"),
    Fault("wrong address of a name", "name-is-wrong", "echo 10.9.9.9 laptop.local >>/etc/hosts"),
    Fault("MTU", "mtu", "ip link set host0 mtu 1300"),
    Fault("dead avahi (the robot's)", "avahi-not-running", "systemctl stop avahi-daemon.socket avahi-daemon"),
    Fault(
        "dead avahi (ours)",
        "avahi-not-running",
        "systemctl stop avahi-daemon.socket avahi-daemon",
        machine="laptop",
    ),
    Fault("missing package", "missing-package", "dpkg --remove --force-depends x11-apps"),
    Fault(
        "failed service",
        "failed-service",
        "systemd-run --quiet --unit=sonar sh -c 'test -e /run/sonar && exec sleep 1000'; sleep 0.1; "
        "until systemctl is-failed --quiet sonar; do sleep 0.1; done",
        fix=False,
        tidy="systemctl stop sonar",
        meanwhile="touch /run/sonar",
    ),
)


def test_healthy_pair_has_no_findings(pair: Bench) -> None:
    done = examine(pair)
    assert (done.code, done.out) == (0, "all is well\n"), done
    pair["laptop"].run(f"{UR} use sim:stage", user="pat").check()  # the set-up has selected the robot
    try:
        alone = pair["laptop"].run(f"{UR} doctor", user="pat").check()
    finally:
        pair["laptop"].run(f"{UR} use bob", user="pat").check()
    said = "a simulated robot is selected: this computer alone (laptop)\nROS: the packages of this computer\n"
    assert alone.out == f"{said}all is well\n"


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.title.replace(" ", "-"))
def test_planted_fault_is_named_and_cured_by_what_is_said(pair: Bench, fault: Fault, table: list[Row]) -> None:
    machine = pair[fault.machine]
    machine.write("/root/other_clock.c", Path(__file__).with_name("other_clock.c").read_text())
    machine.run(["bash", "-c", fault.plant]).check()
    try:
        finding = name(pair, fault.rule)
        machine.run(fault.meanwhile).check()
        if fault.fix:
            assert any(command["fix"] for command in finding["commands"])
            examine(pair, "--fix")
        typed = "--fix" if fault.fix else carry_out(pair, finding)
        wait_until_well(pair)
    finally:
        machine.run(fault.tidy).check()
    table.append((fault.title, fault.rule, typed))


def test_node_that_advertises_an_unknown_name_is_named_and_ended(pair: Bench, table: list[Row]) -> None:
    robot = pair["robot"]
    with running(robot, "roscore", "ros"):
        robot.wait_for("rostopic list", user="ros", deadline=60)
        with running(robot, "env ROS_HOSTNAME=nobody rostopic pub -r 1 /x std_msgs/String hello", "ros"):
            robot.wait_for("rostopic info /x | grep nobody", user="ros", deadline=60)
            finding = name(pair, "unresolvable-node")
            assert "nobody" in finding["message"]
            assert "rostopic pub -r 1 /x" in finding["help"]
            typed = carry_out(pair, finding)
            wait_until_well(pair)
    table.append(("unresolvable advertised name", "unresolvable-node", typed))


def test_messages_that_differ_are_named_and_brought_in_step(pair: Bench, table: list[Row]) -> None:
    both = ((pair["laptop"], "pat", "float64"), (pair["robot"], "ros", "int32"))
    for machine, user, kind in both:
        machine.run(MESSAGE.format(type=kind), user=user).check()
    try:
        finding = name(pair, "different-messages")
        assert "my_msgs" in finding["message"]
        assert "Wheel" in finding["message"]
        typed = carry_out(pair, finding)
        wait_until_well(pair)
    finally:
        for machine, user, _ in both:
            machine.run("rm -r catkin_ws/src/my_msgs", user=user).check()
    table.append(("different message versions", "different-messages", typed))


def test_boot_service_that_fails_is_named_with_its_last_words_and_removed(pair: Bench, table: list[Row]) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    laptop.run(f"{UR} boot install --robot bob --name drive {FAILING}", user="pat", timeout=120)
    try:
        robot.wait_for("[ $(systemctl show -p NRestarts --value ubiquity-drive) -gt 0 ]", deadline=60)
        finding = name(pair, "failing-boot-service")
        assert "ubiquity-drive.service" in finding["message"]
        assert "the motor is missing" in finding["message"]
        typed = carry_out(pair, finding)
        wait_until_well(pair)
    finally:
        laptop.run(f"{UR} boot remove --robot bob drive", user="pat").check()
    table.append(("boot service failing", "failing-boot-service", typed))


def test_second_computer_with_the_name_is_named_and_renamed(pair: Bench, table: list[Row]) -> None:
    pair.boot_stranger("bob")
    pair["laptop"].wait_for("getent ahostsv4 bob-2.local", deadline=60)
    finding = name(pair, "duplicate-name")
    assert "10.77.0.90" in finding["message"]
    # It was just flashed: what it asks on a terminal is given here.
    typed = carry_out(
        pair,
        finding,
        added=" --base magni --no-programs --yes --robot-login --passwords-from 0",
        stdin=f"ros\n{PASSWORD}\n",
    )
    wait_until_well(pair)
    table.append(("duplicate name", "duplicate-name", typed))


def test_way_to_a_robot_that_cannot_be_reached_is_gone_step_by_step(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    unknown = laptop.run(f"{UR} doctor nobody", user="pat")
    assert unknown.code == 2
    assert "NO name nobody.local: not resolved" in unknown.out
    robot.run("systemctl stop ssh.socket ssh.service").check()
    try:
        refused = laptop.run(f"{UR} doctor bob", user="pat")
    finally:
        robot.run("systemctl start ssh.service").check()
    assert refused.code == 2
    assert "ok answer to ping" in refused.out
    assert "[no-ssh-server]" in refused.out
    robot.cut()
    try:
        away = laptop.run(f"{UR} doctor bob", user="pat", timeout=120)
    finally:
        robot.restore()
    assert away.code == 2
    assert "[robot-silent]" in away.out or "[robot-not-found]" in away.out
    assert "Traceback" not in unknown.err + refused.err + away.err
    wait_until_well(pair)
