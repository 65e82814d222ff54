"""The robot's own access point, with a real DHCP server and real logins; only the radio is pretended."""

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace

import pytest
from tests.hosts.bench import UR, Bench, Machine, boot, wait_until
from tests.hosts.managed import PASSWORD, PENDING, wait_reached, wait_settled
from tests.hosts.test_lost_changes import exists
from tests.hosts.test_netplan import INSTALL, LAB_PASSWORD
from tests.hosts.test_robot_setup import PASSWORD as SETUP_PASSWORD
from tests.hosts.test_robot_setup import command, prepare, set_up
from tests.hosts.wireless import MANAGERS, Wireless, wireless_pair

from ur.robot.setup.access_point import (
    PASSWORD as PASSWORD_FILE,
)
from ur.robot.setup.access_point import (
    PROGRAM,
    RADIO,
    UNIT,
    access_point_request,
    want_access_point,
)
from ur.robot.setup.engine import apply_states
from ur.robot.setup.facts import ComputerFacts, FileState
from ur.robot.setup.wanted import Wanted
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import ShellResult

pytestmark = [pytest.mark.timeout(3600)]
SEEK, LOOK = 12, 20  # s, in place of 180 and 120
QUICK = f"[Service]\nExecStart=\nExecStart=/usr/bin/python3 -Iu {PROGRAM} {SEEK} {LOOK}\n"
OPEN, POINT = "/run/ur-access-point/open", "10.83.46.1"
JOINED = "/etc/systemd/network/05-joined.network"
JOIN = "[Match]\nName=host0\n[Network]\nDHCP=ipv4\nMulticastDNS=no\n[DHCPv4]\nClientIdentifier=mac\n"


class RobotShell:
    """Root's shell on a robot, as a set-up has it."""

    def __init__(self, robot: Machine) -> None:
        self._robot, self.destination = robot, "bob"

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 300.0) -> ShellResult:
        given = stdin.reveal() if isinstance(stdin, Secret) else stdin
        done = self._robot.run(["sh", "-c", script], user="root" if root else "ros", stdin=given, timeout=timeout)
        return ShellResult(done.code, done.out, done.err)


def want(facts: ComputerFacts) -> list[Wanted]:
    """List what the set-up installs on a robot with a radio."""
    return want_access_point(replace(facts, files={**facts.files, RADIO: FileState("", folder=True)}), None)


@pytest.fixture(scope="module", params=MANAGERS)
def pair(request: pytest.FixtureRequest) -> Iterator[Wireless]:
    with wireless_pair(request.param) as made:
        robot = made.robot
        radio = robot.root / "usr/sbin/wpa_supplicant"
        robot.run("mkdir -p /etc/ubiquity").check()  # as the robot file has it made
        apply_states(RobotShell(robot), want, "ros", access_point_request("ros"), root=True, report=lambda _: None)
        if made.manager == "netplan":
            (robot.root / "usr/sbin/hostapd").unlink()
            (robot.root / "usr/sbin/hostapd").write_bytes(radio.read_bytes())
            (robot.root / "usr/sbin/hostapd").chmod(0o755)
        robot.write(f"/etc/systemd/system/{UNIT}.d/bench.conf", QUICK)
        robot.run(f"systemctl daemon-reload; systemctl restart {UNIT}").check()
        yield made


# No kernel of the benches lists a wireless device.
LISTED = """\
[Unit]
DefaultDependencies=no
Before=sysinit.target
[Service]
Type=oneshot
RemainAfterExit=yes
ExecStart=mount -t overlay radio -o lowerdir=/opt/radio:/sys/class /sys/class
[Install]
WantedBy=sysinit.target
"""


@pytest.fixture(scope="module")
def fresh() -> Iterator[Bench]:
    """A laptop that was set up, and a robot with a radio, netplan and networkd that was just flashed."""
    with boot(("laptop", "robot")) as bench:
        prepare(bench["laptop"])
        robot = bench["robot"]
        robot.run(INSTALL, timeout=300).check()
        robot.write("/etc/systemd/system/radio.service", LISTED)
        robot.run("mkdir -p /opt/radio/ieee80211/phy0; systemctl enable --now radio").check()
        yield bench


def test_robot_setup_makes_it_and_the_laptop_knows_its_password_until_it_is_refused(fresh: Bench) -> None:
    laptop, robot = fresh["laptop"], fresh["robot"]
    done = set_up(laptop).check()
    assert "ready after" in done.out
    assert "its password: ur robots --access-points" in done.out
    password = robot.read(PASSWORD_FILE).strip()
    assert len(password) == 14
    assert password not in done.out + done.err
    assert robot.run(f"stat -c '%a %U' {PASSWORD_FILE}; systemctl is-enabled {UNIT}").out == "600 root\nenabled\n"
    robot.wait_for(f"systemctl is-active --quiet {UNIT}", deadline=60)
    shown = f"{UR} robots --access-points"
    assert laptop.run(shown, user="pat").check().out == f"WiFi bob: password {password}\n"

    again = set_up(laptop, "bob.local", current="").check()
    assert "nothing to do" in again.out
    assert robot.read(PASSWORD_FILE).strip() == password

    without = command("bob.local", "bob", "--no-access-point")
    laptop.run(without, user="pat", stdin=f"{SETUP_PASSWORD}\n\n", timeout=900).check()
    assert robot.run(f"systemctl cat {UNIT}").code != 0
    assert laptop.run(shown, user="pat").code == 1


def open_point(pair: Wireless, *air: str) -> None:
    """Take the robot's networks away, leaving others in the air, and join its access point with the laptop."""
    pair.set_air(*air)
    pair.robot.wait_for(f"test -e {OPEN} && ip -4 address show wlan0 | grep -q {POINT}", deadline=90)
    pair.laptop.write(JOINED, JOIN)
    pair.laptop.run("networkctl reload").check()
    pair.laptop.wait_for("ip -4 address show host0 | grep -q 'inet 10.83.46'", deadline=60)
    wait_reached(pair.laptop, "bob", POINT)


def leave_point(pair: Wireless) -> None:
    """Have the laptop back in its own network."""
    (pair.laptop.root / JOINED[1:]).unlink()
    pair.laptop.run("networkctl reload").check()
    pair.laptop.wait_for("ip -4 address show host0 | grep -q 'inet 10.77.0.10/'", deadline=60)


def test_password_is_in_a_file_that_only_root_may_read(pair: Wireless) -> None:
    robot = pair.robot
    assert robot.run(f"stat -c '%a %U' {PASSWORD_FILE}").out == "600 root\n"
    password = robot.read(PASSWORD_FILE).strip()
    assert len(password) == 14
    assert robot.run(f"systemctl is-enabled {UNIT}").out == "enabled\n"
    again = apply_states(RobotShell(robot), want, "ros", access_point_request("ros"), root=True, report=lambda _: None)
    assert again[1] == 0
    assert robot.read(PASSWORD_FILE).strip() == password


@pytest.mark.parametrize("trials", [1, pytest.param(10, marks=pytest.mark.nightly)])
def test_access_point_is_opened_and_closed(pair: Wireless, trials: int) -> None:
    for number in range(trials):
        open_point(pair)
        pair.set_air("Home")
        leave_point(pair)
        pair.wait_uses("Home")
        wait_reached(pair.laptop, "bob")
        assert pair.robot.run(f"test -e {OPEN}").code == 1
        sys.stdout.write(f"{pair.manager}: opened and closed {number + 1} of {trials}\n")
        sys.stdout.flush()


def test_user_who_is_logged_in_is_not_thrown_off_when_a_network_returns(pair: Wireless) -> None:
    open_point(pair)
    pair.set_air("Home")
    session = "ssh -o BatchMode=yes -o ServerAliveInterval=2 -o ServerAliveCountMax=2 ros@bob.local"
    said = pair.laptop.run(f"{session} 'sleep {2 * LOOK}; echo here'", user="pat", timeout=300)
    assert said.out == "here\n"
    assert pair.robot.run(f"test -e {OPEN}").code == 0
    leave_point(pair)
    pair.wait_uses("Home")


def give(pair: Wireless, password: str) -> "subprocess.Popen[str]":
    line = f"{UR} robot wifi bob --ssid Lab --passwords-from 0 --wait 60"
    process = pair.laptop.spawn(f"{line} <&0 & wait $!", user="pat", stdin=subprocess.PIPE)
    assert process.stdin
    process.stdin.write(f"{password}\n{PASSWORD}\n")
    process.stdin.close()
    wait_until(lambda: exists(pair.robot, f"{PENDING}/begun"), "the change begins", 60)
    return process


def test_access_point_opens_again_after_a_wrong_password(pair: Wireless) -> None:
    open_point(pair, "Lab")
    with give(pair, "wrong-secret") as process:
        assert process.stdout
        said = process.stdout.read()
    assert "the robot reverted the change" in said, said
    wait_reached(pair.laptop, "bob", POINT)
    pair.set_air("Home")
    leave_point(pair)
    pair.wait_uses("Home")


def test_network_is_joined_over_the_access_point(pair: Wireless) -> None:
    open_point(pair, "Lab")
    with give(pair, LAB_PASSWORD) as process:
        leave_point(pair)
        assert process.stdout
        said = process.stdout.read()
    assert "join Lab: done" in said, said
    pair.wait_uses("Lab")
    pair.set_air("Home")
    pair.wait_uses("Home")
    wait_settled(pair.robot)
