"""The doctor's rules on what was seen: silent on a healthy pair, one finding for one thing that differs."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from msgspec.structs import replace as replace_fields
from tests.robot.doctor.pairs import BOB, LAPTOP, NOBODY, PAIR, ROBOT, WIFI
from tests.robot.doctor.rules.ros2.cases import CASES as ROS2_CASES

from ur.devices.driver_health import DriverHealth, MotionRecord, RefusedCommands
from ur.devices.known import Device, DeviceHolder, DeviceSnapshot, Expected
from ur.robot.doctor.findings import AdvertisedNode, ComputerPair, Owner
from ur.robot.doctor.messages import Message
from ur.robot.doctor.rules import KINDS, diagnose, diagnose_alone
from ur.robot.doctor.side import Disk, FailedUnit, Setting, Side
from ur.robot.doctor.wifi import WirelessLink
from ur.source.foreign.json_values import write_json
from ur.system.releases import System

STOPPED = {"ssh.service": "active", "avahi-daemon.service": "inactive", "chrony.service": "active"}
NO_CHRONY = {**STOPPED, "avahi-daemon.service": "active", "chrony.service": "inactive"}
NO_SSH = {**NO_CHRONY, "chrony.service": "active", "ssh.service": "inactive", "ssh.socket": "inactive"}
WSL = "5.15.153.1-microsoft-standard-WSL2"
DEVICE = Device("/dev/ttyUSB0", "serial", "10c4:ea60", links=("/dev/rplidar",), mode=0o660, group="dialout")
MASTER = {"ROS_MASTER_URI": "http://bob.local:11311"}
DRIVER = DriverHealth("/dev/create", "iRobot Create 2 or Roomba", open=True, frames=66.0, voltage=16.0)
REFUSED = RefusedCommands("cmd_vel: /joy_bridge publishes Twist at 1 Hz", "publish at 10 Hz or more")
TURNED = MotionRecord(21.0, 0.05, 0.0, 0.0, 0.0, 0.0)
OTHER = {"std_msgs/String.msg": Message("xyz", "/usr/share/std_msgs")}


def remote(**changes: object) -> ComputerPair:
    return replace(PAIR, remote=replace(ROBOT, **changes))  # type: ignore[arg-type] # a test's own keywords


def local(**changes: object) -> ComputerPair:
    return replace(PAIR, local=replace(LAPTOP, **changes))  # type: ignore[arg-type] # a test's own keywords


CASES = [
    ("no-network", local(addresses=())),
    ("wsl-network", local(observed={"wsl": f"{WSL}\nnat\n"})),
    ("wsl-network", local(observed={"wsl": f"{WSL}\n"})),  # older ones do not tell the mode
    ("avahi-not-running", remote(active=STOPPED)),
    ("avahi-not-running", local(active=STOPPED)),
    ("name-not-found", remote(resolves=NOBODY)),
    ("name-is-wrong", local(resolves=frozenset({"10.9.9.9"}))),
    ("duplicate-name", remote(announced="bob-2")),
    ("duplicate-name", replace(PAIR, twins={"bob": frozenset({"10.0.0.3"}), "laptop": NOBODY})),
    ("no-ssh-server", local(active=NO_SSH)),
    ("loose-rights", remote(modes={".": 0o777})),
    ("loose-rights", local(modes={".ssh/id_ed25519": 0o644})),
    ("key-refused", replace(PAIR, key_refused=True)),
    ("unknown-host-key-there", replace(PAIR, way_back="Host key verification failed.")),
    ("no-login-there", replace(PAIR, way_back="pat@laptop.local: Permission denied (publickey).")),
    ("no-login-to-itself", remote(own_login="ros@bob.local: Permission denied (publickey).")),
    ("x11-off", remote(x11=False)),
    ("closed-port", replace(PAIR, reaches_local=False)),
    ("closed-port", replace(PAIR, reaches_remote=False)),
    ("mtu", remote(full_frames=False)),
    ("mtu", local(full_frames=False, mtu=1300)),
    ("packet-loss", remote(loss=0.2)),
    ("latency", remote(latency=0.4)),
    ("wrong-ros-ip", remote(ros={**MASTER, "ROS_IP": "10.0.0.7"})),
    ("wrong-ros-hostname", remote(ros={**MASTER, "ROS_HOSTNAME": "robot"})),
    ("wrong-ros-hostname", remote(ros=MASTER)),
    ("wrong-ros-hostname", remote(shell={**MASTER, "ROS_HOSTNAME": "bob"})),
    ("wrong-master", remote(ros={"ROS_HOSTNAME": "bob.local"})),
    ("wrong-master", local(ros={"ROS_HOSTNAME": "laptop.local", "ROS_MASTER_URI": "http://localhost:11311"})),
    ("wrong-ros-hostname", local(ros={**MASTER, "ROS_HOSTNAME": "localhost"})),
    ("unresolvable-node", replace(PAIR, advertised=(AdvertisedNode("/x", "robot", NOBODY, BOB),))),
    ("clock-offset", replace(PAIR, offset=-5.0)),
    ("no-time-synchronisation", remote(active=NO_CHRONY)),
    ("weak-wifi", remote(wifi=(replace(WIFI, signal=-78.0, rate=6.0),))),
    ("slow-wifi", local(wifi=(replace(WIFI, rate=6.0, frequency=2437.0),))),
    ("wifi-power-save", remote(wifi=(replace(WIFI, power_save=True),))),
    ("full-disk", local(disks=(Disk("/", 12.0, 0.99),))),
    ("low-memory", remote(memory_free=40.0)),
    ("under-voltage", remote(observed={"throttled": "throttled=0x50005\n"})),
    ("under-voltage", remote(observed={"throttled": "0x10000\n"})),
    *(
        (rule, remote(observed={"drivers": f"3 {write_json(health)}\n"}))
        for rule, health in (
            ("driver-without-device", replace_fields(DRIVER, open=False, reason="no such file or directory")),
            ("driver-refuses", replace_fields(DRIVER, problem="firmware 20, expected 35 or later")),
            ("driver-silent", replace_fields(DRIVER, frames=0.0)),
            ("damaged-frames", replace_fields(DRIVER, damaged=3.0)),
            ("motors-held", replace_fields(DRIVER, held="its motors have no power (emergency stop?)")),
            ("empty-battery", replace_fields(DRIVER, voltage=11.0, empty=True)),
        )
    ),
    ("refused-commands", remote(observed={"drivers": f"3 {write_json(REFUSED)}\n"})),
    ("not-calibrated", remote(observed={"drivers": f"3 {write_json(TURNED)}\n"})),
    ("failing-boot-service", remote(failing=(FailedUnit("ubiquity-drive.service", 7),))),
    ("failed-service", remote(failing=(FailedUnit("a.service"),))),
    ("missing-package", remote(packages={name: "1" for name in ROBOT.packages if name != "xauth"})),
    ("missing-package", local(packages={name: "1" for name in LAPTOP.packages if name != "sshfs"})),
    ("different-messages", remote(messages=OTHER)),
    *(
        (rule, replace(PAIR, devices=snapshot, expected=(Expected("lidar", "serial", "/dev/rplidar", "rplidar"),)))
        for rule, snapshot in (
            ("missing-device", DeviceSnapshot("ros")),
            ("device-without-name", DeviceSnapshot("ros", devices=(replace(DEVICE, links=()),))),
            ("device-refused", DeviceSnapshot("ros", devices=(replace(DEVICE, allowed=False),))),
            ("device-in-use", DeviceSnapshot("ros", devices=(replace(DEVICE, holders=(DeviceHolder(7, "agetty"),)),))),
        )
    ),
    ("unsupported-release", remote(release=System("ubuntu", version="24.04", name="Ubuntu 24.04"))),
    ("unsupported-release", local(release=System("plan9", name="Plan 9"))),
]


@pytest.mark.parametrize(("rule", "pair"), CASES)
def test_one_difference_is_one_finding_with_something_to_do(rule: str, pair: ComputerPair) -> None:
    (finding,) = diagnose(pair)
    assert finding.rule == rule
    assert finding.help or finding.commands


def test_every_kind_of_finding_is_tried_here_and_explained_to_users() -> None:
    assert {rule for rule, _ in [*CASES, *ROS2_CASES]} == set(KINDS)
    page = Path(__file__).parents[4] / "docs" / "reference" / "doctor.md"
    assert set(KINDS) <= set(re.findall(r"`([a-z0-9-]+)`", page.read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    "pair",
    [
        PAIR,
        replace(PAIR, selected=False, local=replace(LAPTOP, ros={"ROS_HOSTNAME": "localhost"})),
        local(wifi=(WIFI,)),
        local(wifi=(WirelessLink("wlan0"),)),
        local(failing=(FailedUnit("cups.service"),)),  # no business of robots
        local(observed={"wsl": f"{WSL}\nmirrored\n"}),  # it is in the network of Windows
        local(observed={"wsl": "6.1.0-18-amd64\n"}),
        remote(disks=(Disk("/var/log", 30.0, 0.4),)),  # small, and hardly used
        remote(shell=ROBOT.ros),
        remote(release=System("debian", version="13", name="Debian 13")),
        local(release=System("ubuntu", version="24.04", name="Ubuntu 24.04")),  # the project brings ROS 1
        remote(messages={"my_msgs/X.msg": Message("1", "~/catkin_ws/src/my_msgs")}),
    ],
)
def test_healthy_pair_has_no_findings(pair: ComputerPair) -> None:
    assert diagnose(pair) == []


def test_a_computer_alone_is_judged_by_itself() -> None:
    assert diagnose_alone(replace(LAPTOP, resolves=NOBODY, loss=None, full_frames=None)) == []
    (finding,) = diagnose_alone(replace(LAPTOP, active=STOPPED))
    assert finding.commands[0].where == "local"


def test_simulated_robot_needs_no_names_login_or_clock() -> None:
    lone = replace(LAPTOP, active=STOPPED, disks=(Disk("/", 12.0, 0.99),))
    assert [finding.rule for finding in diagnose_alone(lone, simulation=True)] == ["full-disk"]
    assert {finding.rule for finding in diagnose_alone(lone)} > {"full-disk"}


def test_nothing_is_found_where_nothing_was_seen() -> None:
    assert [finding.rule for finding in diagnose_alone(Side(""))] == ["avahi-not-running"]


def commands(pair: ComputerPair) -> list[tuple[str, str, bool]]:
    (finding,) = diagnose(pair)
    return [(command.where, command.typed, command.safe) for command in finding.commands]


def test_power_saving_is_switched_off_where_it_is_on() -> None:
    pair = local(wifi=(replace(WIFI, power_save=True),))
    assert commands(pair) == [("local", "sudo iw dev wlan0 set power_save off", True)]


def test_what_is_printed_is_one_line_for_a_shell() -> None:
    ((_, typed, _),) = commands(local(active=NO_CHRONY))
    assert typed == "sudo systemctl enable --now chrony"
    ((_, typed, _),) = commands(replace(PAIR, offset=5.0))
    assert typed.startswith("sudo sh -c 'systemctl restart chrony && ")


def test_lines_of_the_user_are_only_taken_out_by_the_user() -> None:
    settings = (Setting("/home/ros/.bashrc", "ROS_IP"), Setting("/home/ros/.ros_setup", "ROS_HOSTNAME"))
    ((where, typed, safe),) = commands(remote(shell={**MASTER, "ROS_IP": "10.0.0.7"}, settings=settings))
    assert (where, safe) == ("remote", False)
    assert typed.endswith("/home/ros/.bashrc")


def test_own_file_of_variables_is_written_again() -> None:
    ((where, typed, safe),) = commands(remote(ros={"ROS_HOSTNAME": "bob.local"}, ros_setup="export X=1\n"))
    assert (where, safe) == ("remote", True)
    assert typed.endswith(">~/.ros_setup")


def test_shell_that_is_older_than_the_selection_is_renewed() -> None:
    good = dict(LAPTOP.ros)
    old = {"ROS_HOSTNAME": "laptop.local", "ROS_MASTER_URI": "http://localhost:11311"}
    assert commands(local(ros=old, shell=good)) == [("local", 'eval "$(ur env)"', False)]
    assert commands(local(ros=old, shell=old)) == [("local", "ur setup", False)]


def test_node_with_a_lost_name_is_ended_where_it_runs_or_its_service_restarted() -> None:
    lost = AdvertisedNode("/x", "robot", NOBODY, NOBODY, Owner("remote", 12, "rostopic pub /x"))
    ((where, typed, safe),) = commands(replace(PAIR, advertised=(lost,)))
    assert (where, safe) == ("remote", False)
    assert typed.startswith("kill -INT 12;")
    unit = replace(lost, owner=Owner("remote", 12, "x", "ubiquity-x.service"))
    ((_, typed, _),) = commands(replace(PAIR, advertised=(unit,)))
    assert typed == "sudo systemctl restart ubiquity-x.service"


def test_smaller_frames_are_the_ones_to_be_changed() -> None:
    assert commands(local(full_frames=False, mtu=1300)) == [("local", "sudo ip link set wlan0 mtu 1500", True)]
    assert commands(remote(full_frames=False)) == []


@pytest.mark.parametrize("firewall", ["ufw", "firewalld", "nft", "iptables"])
def test_firewall_lets_the_other_computer_in_and_nobody_else(firewall: str) -> None:
    ((where, typed, safe),) = commands(replace(remote(firewall=firewall), reaches_remote=False))
    assert (where, safe) == ("remote", False)
    assert "10.0.0.1" in typed


def test_what_fills_a_disk_is_emptied_on_that_disk_only() -> None:
    disks = (Disk("/", 9000.0, 0.5), Disk("/home/ros", 3.0, 0.99))
    large = {"/home/ros/.ros/log": 70.0, "/var/cache/apt": 400.0, "/home/ros/.cache": 1.0}
    assert commands(remote(disks=disks, large=large)) == [("remote", "rosclean purge -y", False)]


def test_messages_of_workspaces_are_copied_and_those_of_packages_upgraded() -> None:
    mine = local(messages={"my_msgs/X.msg": Message("1", "~/catkin_ws/src/my_msgs")})
    theirs = {"my_msgs/X.msg": Message("2", "~/catkin_ws/src/my_msgs")}
    pair = replace(mine, remote=replace(ROBOT, messages=theirs, built=True))
    assert commands(pair) == [
        ("local", "rsync -a ~/catkin_ws/src/my_msgs/ ros@bob.local:catkin_ws/src/my_msgs/", False),
        ("remote", "cd ~/catkin_ws && catkin_make", False),
    ]


def test_messages_of_packages_are_upgraded_on_both() -> None:
    names = {"python3-std-msgs": "1"}
    mine, theirs = {**LAPTOP.packages, **names}, {**ROBOT.packages, **names}
    pair = replace(local(packages=mine), remote=replace(ROBOT, packages=theirs, messages=OTHER))
    assert [where for where, _, _ in commands(pair)] == ["local", "remote"]
    assert "--only-upgrade python3-std-msgs" in commands(pair)[0][1]


def test_definition_that_was_not_built_since_is_built() -> None:
    built = "~/catkin_ws/devel/lib/python3/dist-packages/my_msgs"
    mine = local(messages={"my_msgs/X": Message("1", built)})
    pair = replace(mine, remote=replace(ROBOT, messages={"my_msgs/X": Message("2", built)}, built=True))
    assert commands(pair) == [("remote", "cd ~/catkin_ws && catkin_make", False)]


def test_robot_that_was_not_set_up_from_here_gets_no_login_by_itself() -> None:
    pair = replace(PAIR, way_back="Permission denied (publickey).")
    assert all(safe for _, _, safe in commands(pair))
    assert [safe for _, _, safe in commands(replace(pair, known=False))] == [True, False]


def test_robot_whose_login_here_was_declined_is_not_asked_to_have_one() -> None:
    pair = replace(PAIR, way_back="Permission denied (publickey).")
    assert "no-login-there" in {finding.rule for finding in diagnose(pair)}
    assert "no-login-there" not in {finding.rule for finding in diagnose(replace(pair, robot_login=False))}


def test_container_is_not_blamed_for_devices_that_its_host_does_not_pass_on() -> None:
    expected = (Expected("base", "serial", "/dev/ttyAMA0", "pi-uart"),)
    assert diagnose(replace(PAIR, devices=DeviceSnapshot("ros", container=True), expected=expected)) == []
