"""Changes of name and network on robots with netplan, under NetworkManager and under systemd-networkd."""

import json
import random
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.hosts.bench import UR, Bench, Machine, boot, wait_until
from tests.hosts.managed import (
    PASSWORD,
    PROFILE_UUID,
    SETTINGS,
    TAKE_OVER,
    has_other_leader,
    wait_reached,
    wait_settled,
    wait_up,
)
from tests.hosts.test_lost_changes import NETWORK, RENAME, WAIT, Blow, strike
from tests.hosts.test_wifi_change import ur
from tests.hosts.watch import Watcher, find_written

pytestmark = [pytest.mark.timeout(3600)]
INSTALL = "apt-get -qq update && apt-get -qqy --no-install-recommends install netplan.io wpasupplicant"
MANAGED = f"""\
network:
  version: 2
  ethernets:
    NM-{PROFILE_UUID}:
      renderer: NetworkManager
      match: {{name: host0}}
      networkmanager: {{uuid: {PROFILE_UUID}, name: wired}}
      addresses: [10.77.0.11/24]
"""
# NetworkManager of Ubuntu 24.04 and Raspberry Pi OS 13 writes its profiles to /etc/netplan; Debian's leaves them alone.
WRITER = """\
#!/bin/sh
case "$*" in "connection modify "*)
  sed -i "s|addresses: .*|addresses: [$7]|" /etc/netplan/90-NM-*.yaml && netplan generate
  exec /usr/bin/nmcli connection reload;;
esac
exec /usr/bin/nmcli "$@"
"""


@contextmanager
def login_pair() -> Iterator[Bench]:
    """Make no more than a login by key: setting a robot up takes minutes, and changes nothing about networks."""
    with boot(("laptop", "bob")) as booted:
        laptop, robot = booted["laptop"], booted["bob"]
        robot.run(INSTALL, timeout=300).check()
        robot.write("/usr/local/bin/udevadm", "#!/bin/sh\n", mode=0o755)  # a container has none
        laptop.run("mkdir -pm 700 .ssh; ssh-keygen -q -t ed25519 -N '' -f .ssh/id_ed25519", user="pat").check()
        laptop.write("/home/pat/.ssh/known_hosts", f"bob.local {robot.read('/etc/ssh/ssh_host_ed25519_key.pub')}")
        laptop.write("/home/pat/.ssh/config", "Host bob.local eve.local\nUser ros\n")
        robot.write("/home/ros/.ssh/authorized_keys", laptop.read("/home/pat/.ssh/id_ed25519.pub"))
        laptop.run("chown -R pat: /home/pat/.ssh").check()
        robot.run(f"chown -R ros: /home/ros/.ssh; echo ros:{PASSWORD} | chpasswd").check()
        yield Bench(booted.ledger, {"laptop": laptop, "robot": robot}, booted.root)


@pytest.fixture
def managed() -> Iterator[Bench]:
    """A robot whose NetworkManager keeps its profiles in netplan."""
    with login_pair() as bench:
        robot = bench["robot"]
        robot.write(f"/etc/netplan/90-NM-{PROFILE_UUID}.yaml", MANAGED, mode=0o600)
        robot.write("/usr/local/bin/nmcli", WRITER, mode=0o755)
        robot.write("/etc/NetworkManager/conf.d/bench.conf", SETTINGS)
        robot.run(f"netplan generate && {TAKE_OVER}").check()
        wait_up(robot)
        wait_reached(bench["laptop"], "bob", robot.address)
        yield bench


def test_power_cut_takes_an_address_back_that_netplan_has_stored_for_network_manager(managed: Bench) -> None:
    laptop, robot = managed["laptop"], managed["robot"]
    assert robot.address == "10.77.0.11"
    ended = strike(managed, Blow(NETWORK, "made", cut=True, power=True))
    wait_up(robot)
    wait_settled(robot)
    robot.restore()
    wait_reached(laptop, "bob", robot.address)
    assert "Traceback" not in ended()


CLOUD = """\
# This file is generated from information provided by the datasource.
network:
    version: 2
    ethernets:
        wired: {match: {name: "h*"}, addresses: [10.77.0.11/24], optional: true}
"""
WIRELESS = """\
# This file is generated from information provided by the datasource.
network:
    version: 2
    wifis:
        wlan0: {dhcp4: true, optional: true, access-points: {"Home": {password: "%s"}}}
"""
HOME_PASSWORD, LAB_PASSWORD = "home-secret-5772", "06172635447"
AIR = {
    "Home": [HOME_PASSWORD, True, -50],
    "Lab": [LAB_PASSWORD, True, -70],
    "Läb 2": ["umlaut-secret", True, -75],
    "Cellar": ["cellar-secret", False, -80],
    "Guests": ["", True, -85],
}
# The radio's other end on a bridge of the robot itself, before networkd as udev would bring it.
ETHER = """\
[Unit]
DefaultDependencies=no
Wants=network-pre.target
Before=network-pre.target systemd-networkd.service
[Service]
Type=oneshot
RemainAfterExit=yes
ExecStart=/bin/sh -c 'ip link add air type veth peer name wlan0; ip link set wlan0 address 02:00:00:00:00:11; \
ip link add ether type bridge; ip link set host0 master ether; ip link set host0 up; ip link set ether up'
[Install]
WantedBy=systemd-networkd.service
"""
LINKS = """\
#!/bin/sh
case "$*" in *--no-legend*) /usr/bin/networkctl "$@" | sed 's/wlan0\\( *\\)ether/wlan0\\1wlan /';;
*) exec /usr/bin/networkctl "$@";; esac
"""
# Without udev, systemd knows no devices, which wpa_supplicant would wait for.
GENERATOR = """\
#!/bin/bash
(exec -a "$0" /usr/libexec/netplan/generate.real "$@") || exit
sed -i /sys-subsystem-net-devices/d /run/systemd/system/netplan-wpa-*.service 2>/dev/null; true
"""
SERVER = (
    "f=/etc/systemd/network/10-host0.network; sed -i s/DHCP=no/DHCPServer=yes/ $f; printf "
    "'[DHCPServer]\\nPoolOffset=100\\nPoolSize=50\\nEmitDNS=no\\nEmitRouter=no\\n' >>$f; "
    "networkctl reload; networkctl reconfigure host0"
)
FILES = "find /etc/netplan /run/netplan /etc/systemd/system /etc/hostname -type f -exec sha256sum {} + | sort -k 2"


@pytest.fixture(scope="module")
def served() -> Iterator[Bench]:
    """A robot as Ubuntu's server images have it: cloud-init's file for netplan, and systemd-networkd."""
    with login_pair() as bench:
        robot = bench["robot"]
        robot.write("/etc/netplan/50-cloud-init.yaml", CLOUD, mode=0o600)
        robot.run("rm /etc/systemd/network/10-host0.network && netplan apply").check()
        wait_reached(bench["laptop"], "bob", robot.address)
        yield bench


def make_wireless(bench: Bench) -> None:
    """Put the robot's only connection on a pretended radio."""
    laptop, robot = bench["laptop"], bench["robot"]
    laptop.run(SERVER).check()
    robot.write("/etc/bench-air.json", json.dumps(AIR))
    for name in ("wpa_supplicant", "wpa_cli"):
        path = robot.root / "usr/sbin" / name
        path.unlink()
        shutil.copy(Path(__file__).parent / "bench/radio.py", path)
        path.chmod(0o755)
    robot.run("mv /usr/libexec/netplan/generate /usr/libexec/netplan/generate.real").check()
    robot.write("/usr/libexec/netplan/generate", GENERATOR, mode=0o755)
    robot.write("/usr/local/bin/networkctl", LINKS, mode=0o755)
    robot.write("/etc/systemd/system/ether.service", ETHER)
    robot.write("/etc/netplan/50-cloud-init.yaml", WIRELESS % HOME_PASSWORD, mode=0o600)
    robot.run("rm -f /etc/netplan/90-ur.yaml; systemctl mask wpa_supplicant; systemctl enable ether").check()
    robot.run("ln -s /dev/null /etc/systemd/network/80-container-host0.network").check()
    reboot(robot)
    wait_reached(laptop, "bob")


def reboot(robot: Machine) -> None:
    leader = robot.leader
    robot.run("systemctl reboot --no-block")
    wait_until(lambda: has_other_leader(robot, leader), "the robot starts again", 120)
    wait_served(robot)


def wait_served(robot: Machine) -> None:
    units = ("ssh", "avahi-daemon", "systemd-networkd")
    robot.wait_for(" && ".join(f"systemctl is-active --quiet {unit}" for unit in units), deadline=120)


def look(bench: Bench) -> list[str]:
    """All that must be as before: files, what is remembered on the laptop, name, addresses and the network."""
    robot, laptop = bench["robot"], bench["laptop"]
    addresses = "ip -brief -4 address show scope global | awk '{print $3}'"
    network = "wpa_cli -i wlan0 status | grep ssid"
    return [
        robot.run(FILES).check().out,
        robot.run(f"cat /proc/sys/kernel/hostname; {addresses}; {network}").out,
        laptop.run("cat .ssh/known_hosts .config/ubiquity_launches/robots/*", user="pat").out,
    ]


def test_address_of_a_server_image_is_changed_confirmed_and_kept_over_a_reboot(served: Bench) -> None:
    laptop, robot = served["laptop"], served["robot"]
    cloud = robot.read("/etc/netplan/50-cloud-init.yaml")
    done = ur(laptop, "network bob --address 10.77.0.99/24").check()
    assert "ros@10.77.0.99: answers, confirmed" in done.out
    wait_settled(robot)
    assert robot.run("ip -4 -brief address show host0 | awk '{print $3, $4}'").out == "10.77.0.99/24 \n"
    assert robot.run("stat -c '%a %U' /etc/netplan/90-ur.yaml; ls /run/netplan").out == "600 root\n"
    reboot(robot)
    wait_reached(laptop, "bob", "10.77.0.99")
    ur(laptop, "network bob --address 10.77.0.11/24").check()
    wait_settled(robot)
    wait_reached(laptop, "bob", "10.77.0.11")
    assert robot.read("/etc/netplan/50-cloud-init.yaml") == cloud


def test_power_cut_takes_an_address_back_on_a_server_image(served: Bench) -> None:
    before = look(served)
    for moment in ("begun", "made"):
        endure(served, Blow(NETWORK, moment, cut=True, power=True))
        assert look(served) == before


def endure(bench: Bench, blow: Blow) -> str:
    """Let a blow fall, then wait until the laptop gets into the robot, strictly, within 120 s; return what was said."""
    laptop, robot = bench["laptop"], bench["robot"]
    said = strike(bench, blow)
    wait_served(robot)
    wait_settled(robot)
    robot.restore()
    wait_reached(laptop, "bob")
    text = said()
    assert "Traceback" not in text, text
    return text


@pytest.fixture(scope="module")
def radio(served: Bench) -> Bench:
    """The same robot, with nothing but WiFi."""
    make_wireless(served)
    return served


def test_networks_of_a_server_image_are_listed_with_those_it_knows(radio: Bench) -> None:
    said = ur(radio["laptop"], "wifi bob", "").check().out
    assert "wlan0 uses Home, 10.77.0." in said
    for ssid in AIR:
        assert ssid in said


def test_network_joined_through_netplan_stays_over_a_reboot_and_its_password_is_nowhere_else(radio: Bench) -> None:
    laptop, robot = radio["laptop"], radio["robot"]
    cloud = robot.read("/etc/netplan/50-cloud-init.yaml")
    for ssid, password in (("Läb 2", "umlaut-secret"), ("Lab", LAB_PASSWORD), ("Guests", "")):
        with Watcher((password or "none-at-all", PASSWORD)) as watcher:
            done = ur(laptop, f"wifi bob --ssid '{ssid}'", password)
            wait_settled(robot)
        done.check()
        assert watcher.seen == set()
        assert f"uses {ssid}, 10.77.0." in ur(laptop, "wifi bob", "").check().out
    reboot(robot)
    wait_reached(laptop, "bob")
    assert "ssid=Guests\n" in robot.run("wpa_cli -i wlan0 status").out
    ours = ("/etc/netplan/90-ur.yaml", "/run/netplan/wpa-wlan0.conf", "/etc/bench-air.json")
    found = [path for path in find_written(robot, ("umlaut-secret", LAB_PASSWORD)) if not path.endswith(ours)]
    assert found == []
    assert robot.read("/etc/netplan/50-cloud-init.yaml") == cloud
    for ssid in ("Guests", "Lab", "Läb 2"):
        ur(laptop, f"wifi bob --forget '{ssid}'", "").check()
        wait_settled(robot)
    assert "ssid=Home\n" in robot.run("wpa_cli -i wlan0 status").out
    assert "secret" not in robot.read("/etc/netplan/90-ur.yaml")


def test_wrong_password_leaves_a_server_image_as_it_was(radio: Bench) -> None:
    laptop, robot = radio["laptop"], radio["robot"]
    before = look(radio)
    done = ur(laptop, "wifi bob --ssid Lab", "wrong-secret")
    assert done.code == 2
    assert "join Lab: the robot reverted the change: the network refuses the password" in done.err
    wait_settled(robot)
    assert look(radio) == before
    assert find_written(robot, ("wrong-secret",)) == []


CELLAR = (f"{UR} robot wifi bob --ssid Cellar --passwords-from 0 --wait {WAIT}", "cellar-secret")
LAB = (f"{UR} robot wifi bob --ssid Lab --passwords-from 0 --wait {WAIT}", LAB_PASSWORD)
LOSSES = tuple(
    Blow(change, moment, cut, kill, power, given)
    for change, *given in (LAB, CELLAR, (RENAME,), (NETWORK,))
    for moment, cut, kill, power in (
        ("told", True, False, False),
        ("begun", True, True, False),
        ("begun", True, False, True),
        ("made", True, True, False),
        ("made", True, False, True),
    )
)


@pytest.mark.parametrize("trials", [8, pytest.param(50, marks=pytest.mark.nightly)])
def test_server_image_is_never_lost(radio: Bench, trials: int) -> None:
    losses = random.Random(51).sample(LOSSES, len(LOSSES))
    before = look(radio)
    for number in range(trials):
        blow = losses[number % len(losses)]
        endure(radio, blow)
        assert look(radio) == before, blow
        sys.stdout.write(f"{number + 1} of {trials}: {blow}: it came back\n")
