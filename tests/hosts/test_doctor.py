"""`ur doctor` on a pair that was set up: silent on a healthy one; planted faults are named and, where it can, cured."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import pytest
from tests.hosts.bench import UR, Bench, Done, boot
from tests.hosts.test_robot_setup import PASSWORD, prepare, running, set_up

pytestmark = pytest.mark.long
BLOCK = (
    "nft add table ip test && nft add chain ip test in '{ type filter hook input priority 0; }' && "
    "nft add rule ip test in tcp dport 1024-65535 tcp flags '&' '(syn|ack)' == syn drop"
)
DF = "#!/bin/sh\necho 'overlay 1000 990 10 99% /'\n"
SHIM = "#!/bin/sh\nexec /usr/bin/date -d '5 seconds' \"$@\"\n"


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    with boot(("laptop", "robot")) as bench:
        prepare(bench["laptop"])
        set_up(bench["laptop"]).check()
        bench["robot"].write("/etc/sudoers.d/ros", "ros ALL=(ALL) NOPASSWD: ALL\n", mode=0o440)
        yield bench


def examine(pair: Bench, *options: str) -> Done:
    line = f"{UR} doctor bob --password-from 0 {' '.join(options)}"
    return pair["laptop"].run(line, user="pat", stdin=f"{PASSWORD}\n", timeout=120)


@dataclass(frozen=True)
class Fault:
    """A fault: how it is planted, which finding names it, and how it goes away when --fix does not cure it."""

    rule: str
    machine: str
    plant: str
    remove: str = ""


FAULTS = (
    Fault("avahi-not-running", "robot", "systemctl stop avahi-daemon.socket avahi-daemon"),
    Fault("name-is-wrong", "robot", "echo 10.9.9.9 laptop.local >>/etc/hosts"),
    Fault(
        "wrong-master", "robot", "echo 'export ROS_MASTER_URI=http://elsewhere:11311' >>/home/ros/.ros_setup", "RESET"
    ),
    Fault(
        "wrong-ros-ip",
        "robot",
        "printf 'unset ROS_HOSTNAME\\nexport ROS_IP=192.0.2.1\\n' >>/home/ros/.ros_setup",
        "RESET",
    ),
    Fault("wrong-ros-hostname", "robot", "echo 'export ROS_HOSTNAME=robot' >>/home/ros/.ros_setup", "RESET"),
    Fault("clock-offset", "robot", "SHIM", "rm /usr/local/bin/date"),
    Fault(
        "key-refused", "robot", "mv /home/ros/.ssh/authorized_keys /root/", "mv /root/authorized_keys /home/ros/.ssh/"
    ),
    Fault("loose-rights", "robot", "chmod 777 /home/ros/.ssh"),
    Fault(
        "no-login-there",
        "robot",
        "mv /home/ros/.ssh/id_ed25519 /home/ros/.ssh/away",
        "mv /home/ros/.ssh/away /home/ros/.ssh/id_ed25519",
    ),
    Fault(
        "unknown-host-key-there",
        "robot",
        "cp -p /home/ros/.ssh/known_hosts /root/kept; : >/home/ros/.ssh/known_hosts",
        "cp -p /root/kept /home/ros/.ssh/known_hosts",
    ),
    Fault("failed-service", "robot", "systemd-run --unit=ubiquity-test false", "systemctl reset-failed"),
    Fault("no-time-synchronisation", "robot", "systemctl disable --now chrony"),
    Fault("full-disk", "robot", "DF", "rm /usr/local/bin/df"),
    Fault("mtu", "robot", "ip link set host0 mtu 1300", "ip link set host0 mtu 1500"),
    Fault("missing-package", "robot", "dpkg --remove --force-depends x11-apps", "apt-get -y install x11-apps"),
    Fault("closed-port", "robot", BLOCK, "nft delete table ip test"),
)


def test_healthy_pair_has_no_findings(pair: Bench) -> None:
    done = examine(pair)
    assert (done.code, done.out) == (0, "all is well\n"), done


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.rule)
def test_planted_fault_is_named_and_goes_away(pair: Bench, fault: Fault) -> None:
    machine = pair[fault.machine]
    kept = machine.run("tar cf /root/kept.tar -C /home/ros .ros_setup .bashrc").check()
    assert kept.code == 0
    if fault.plant == "SHIM":
        machine.write("/usr/local/bin/date", SHIM, mode=0o755)
    elif fault.plant == "DF":
        machine.write("/usr/local/bin/df", DF, mode=0o755)
    else:
        machine.run(fault.plant).check()
    done = examine(pair)
    assert f"[{fault.rule}]" in done.out, done
    assert done.code == 1
    if not fault.remove:
        examine(pair, "--fix")
    elif fault.remove == "RESET":
        machine.run("tar xf /root/kept.tar -C /home/ros").check()
    else:
        machine.run(fault.remove).check()
    pair["laptop"].wait_for("getent ahostsv4 bob.local && ping -c 1 bob.local")
    machine.wait_for("getent ahostsv4 laptop.local")
    healed = examine(pair)
    assert (healed.code, healed.out) == (0, "all is well\n"), healed


def test_node_that_advertises_an_unknown_name_is_named(pair: Bench) -> None:
    robot = pair["robot"]
    with running(robot, "roscore", "ros"):
        robot.wait_for("rostopic list", user="ros")
        with running(robot, "env ROS_HOSTNAME=nobody rostopic pub -r 1 /x std_msgs/String hello", "ros"):
            robot.wait_for("rostopic info /x | grep nobody", user="ros")
            done = examine(pair)
    assert "[unresolvable-node]" in done.out
    assert "nobody" in done.out


def test_robot_with_another_host_key_is_explained(pair: Bench) -> None:
    laptop = pair["laptop"]
    swap = (
        "cp .ssh/known_hosts kept; ssh-keygen -R bob.local; "
        "echo bob.local $(cut -d' ' -f1,2 /etc/ssh/ssh_host_ed25519_key.pub) >>.ssh/known_hosts"
    )
    laptop.run(swap, user="pat").check()
    done = examine(pair)
    laptop.run("cp kept .ssh/known_hosts", user="pat").check()
    assert done.code == 2
    assert "--new-host-key" in done.err
