"""The doctor's rules on what was seen: silent on a healthy pair, one finding for one thing that differs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from ur.robot.doctor.observe import Side, parse_side
from ur.robot.doctor.rules import Advertised, Pair, diagnose
from ur.robot.doctor.wifi import Wifi
from ur.robot.setup.there import PACKAGES

UNITS = {"ssh.service": "active", "avahi-daemon.service": "active", "chrony.service": "active"}
LAPTOP = Side(
    "laptop",
    ("10.0.0.1",),
    frozenset({"10.0.0.2"}),
    modes={".": 0o755, ".ssh": 0o700},
    active=UNITS,
    announced="laptop",
    disk_free=9000.0,
    memory_free=2000.0,
    loss=0.0,
    latency=0.002,
    full_frames=True,
    messages={"ros-std-msgs": "1"},
)
ROBOT = replace(
    LAPTOP,
    name="bob",
    addresses=("10.0.0.2",),
    resolves=frozenset({"10.0.0.1"}),
    ros={"ROS_MASTER_URI": "http://bob.local:11311", "ROS_HOSTNAME": "bob.local"},
    announced="bob",
    packages=frozenset(entry.split("|")[0] for entry in PACKAGES),
)
PAIR = Pair(LAPTOP, ROBOT, offset=0.0, way_back="", reaches_there=True, reaches_here=True)
WIFI = Wifi("wlan0", 5180.0, -50.0, 400.0, power_save=False)
NOBODY: frozenset[str] = frozenset()


def test_healthy_pair_has_no_findings() -> None:
    assert diagnose(PAIR) == []


@pytest.mark.parametrize(
    ("rule", "pair"),
    [
        ("name-not-found", replace(PAIR, there=replace(ROBOT, resolves=NOBODY))),
        ("name-is-wrong", replace(PAIR, here=replace(LAPTOP, resolves=frozenset({"10.9.9.9"})))),
        ("duplicate-name", replace(PAIR, there=replace(ROBOT, announced="bob-2"))),
        (
            "wrong-ros-ip",
            replace(PAIR, there=replace(ROBOT, ros={**ROBOT.ros, "ROS_HOSTNAME": "", "ROS_IP": "10.0.0.7"})),
        ),
        ("wrong-ros-hostname", replace(PAIR, there=replace(ROBOT, ros={**ROBOT.ros, "ROS_HOSTNAME": "robot"}))),
        ("wrong-master", replace(PAIR, there=replace(ROBOT, ros={"ROS_HOSTNAME": "bob.local"}))),
        ("clock-offset", replace(PAIR, offset=-5.0)),
        ("different-messages", replace(PAIR, there=replace(ROBOT, messages={"ros-std-msgs": "2"}))),
        ("under-voltage", replace(PAIR, there=replace(ROBOT, throttled=0x50005))),
        ("packet-loss", replace(PAIR, there=replace(ROBOT, loss=0.2))),
        ("latency", replace(PAIR, there=replace(ROBOT, latency=0.4))),
        ("low-memory", replace(PAIR, there=replace(ROBOT, memory_free=40.0))),
        ("full-disk", replace(PAIR, here=replace(LAPTOP, disk_free=12.0))),
        ("mtu", replace(PAIR, there=replace(ROBOT, full_frames=False))),
        ("closed-port", replace(PAIR, reaches_here=False)),
        ("unresolvable-node", replace(PAIR, advertised=(Advertised("/x", "robot", NOBODY, frozenset({"10.0.0.2"})),))),
        ("unknown-host-key-there", replace(PAIR, way_back="Host key verification failed.")),
        ("no-login-there", replace(PAIR, way_back="pat@laptop.local: Permission denied (publickey).")),
        ("weak-wifi", replace(PAIR, there=replace(ROBOT, wifi=(replace(WIFI, signal=-78.0, rate=6.0),)))),
        ("slow-wifi", replace(PAIR, here=replace(LAPTOP, wifi=(replace(WIFI, rate=6.0, frequency=2437.0),)))),
        ("wifi-power-save", replace(PAIR, there=replace(ROBOT, wifi=(replace(WIFI, power_save=True),)))),
        ("failed-service", replace(PAIR, there=replace(ROBOT, failed=("ubiquity-drive.service",)))),
    ],
)
def test_one_difference_is_one_finding(rule: str, pair: Pair) -> None:
    assert [finding.rule for finding in diagnose(pair)] == [rule]


def test_good_or_unseen_wireless_link_has_no_findings() -> None:
    for wifi in (WIFI, Wifi("wlan0")):
        assert diagnose(replace(PAIR, here=replace(LAPTOP, wifi=(wifi,)), there=replace(ROBOT, wifi=(wifi,)))) == []


def test_power_saving_is_switched_off_where_it_is_on() -> None:
    (finding,) = diagnose(replace(PAIR, here=replace(LAPTOP, wifi=(replace(WIFI, power_save=True),))))
    assert finding.fix
    assert (finding.fix.where, finding.fix.root) == ("here", True)
    assert finding.fix.script.endswith("iw dev wlan0 set power_save off")


def test_findings_say_what_to_do() -> None:
    for pair in (replace(PAIR, offset=5.0), replace(PAIR, there=replace(ROBOT, resolves=NOBODY))):
        assert all(finding.help for finding in diagnose(pair))


def test_what_was_not_seen_is_no_finding() -> None:
    unseen = parse_side("")
    assert unseen.disk_free is None
    assert unseen.loss is None


def test_side_is_read_from_the_answer_of_a_computer() -> None:
    side = parse_side(Path(__file__).with_name("side.txt").read_bytes().decode())
    assert side == Side(
        "bob",
        ("10.0.0.2",),
        frozenset({"10.0.0.1"}),
        ros={"ROS_MASTER_URI": "http://bob.local:11311"},
        modes={".": 0o755, ".ssh": 0o700},
        active={"ssh.service": "active"},
        failed=("a.service",),
        announced="bob",
        disk_free=100.0,
        memory_free=2.0,
        loss=0.2,
        latency=0.004,
        full_frames=False,
        throttled=0x50005,
        messages={"ros-std-msgs": "0.5"},
        packages=frozenset({"ros-std-msgs"}),
    )
