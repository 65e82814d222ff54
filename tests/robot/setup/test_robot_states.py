"""What a robot shall be: the order of its making, and texts that their readers understand."""

from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from ur.robot.discovery.ask import clock_offset
from ur.robot.robot_file import ROBOT_FILE, RobotFile, load_robot_file
from ur.robot.setup.access_point import access_point_request
from ur.robot.setup.facts import ABSENT, ComputerFacts, FileState, ServiceState
from ur.robot.setup.keys import HOST_KEY
from ur.robot.setup.raspberry_pi import header
from ur.robot.setup.robot_states import (
    AVAHI,
    CLOUD,
    ViewerFacts,
    WantedPassword,
    WantedRobot,
    announcement,
    is_robot_name,
    robot_file,
    wanted_there,
)
from ur.robot.setup.wanted import WantedFile
from ur.robot.ssh.secret import Secret

HOST, OWN = (
    "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIEFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFB",
    "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIEJCQkJCQkJCQkJCQkJCQkJCQkJCQkJCQkJCQkJCQkJC",
)
FACTS = ComputerFacts(
    "ros",
    "/home/ros",
    "robot",
    "debian bookworm",
    "1",
    frozenset(),
    files={
        **dict.fromkeys(header.FILES | access_point_request("ros").files, ABSENT),
        HOST_KEY: FileState(f"{HOST} root@robot\n"),
        CLOUD: ABSENT,
        AVAHI: ABSENT,
        str(ROBOT_FILE): ABSENT,
    },
    services=dict.fromkeys(access_point_request("ros").services, ServiceState()),
)
VIEWER = ViewerFacts("pat", "laptop", f"{OWN} pat@laptop\n", f"{HOST}\n")
ROBOT = WantedRobot("bob", "magni", "lidar")


def test_way_in_comes_first_and_the_name_last() -> None:
    titles = [item.title for item in wanted_there(FACTS, ROBOT, VIEWER, WantedPassword(Secret("x"), is_set=False))]
    assert titles.index("login from the viewer") < titles.index("packages") < titles.index("password")
    assert titles[-1] == "host name"


def test_password_is_set_through_standard_input_only() -> None:
    change = WantedPassword(Secret("hunter2"), is_set=False).plan(FACTS)
    assert change is not None
    assert "hunter2" not in repr(change)
    assert "hunter2" not in change.commands[0].script
    assert WantedPassword(Secret("hunter2"), is_set=True).plan(FACTS) is None


def test_cloud_init_is_told_to_keep_the_name_only_where_it_is() -> None:
    with_cloud = replace(FACTS, files={**FACTS.files, CLOUD: FileState("x")})
    assert "cloud-init" not in [item.title for item in wanted_there(FACTS, ROBOT, VIEWER, None)]
    assert "cloud-init" in [item.title for item in wanted_there(with_cloud, ROBOT, VIEWER, None)]


def test_avahi_tells_no_other_name_than_that_of_the_computer() -> None:
    settings = "[server]\n#host-name=foo\n"
    own = replace(FACTS, files={**FACTS.files, AVAHI: FileState(settings.replace("#", ""))})
    (item,) = (item for item in wanted_there(own, ROBOT, VIEWER, None) if item.title == "host name (avahi)")
    assert isinstance(item, WantedFile)
    assert item.text == settings
    plain = replace(FACTS, files={**FACTS.files, AVAHI: FileState(settings)})
    assert "host name (avahi)" not in [item.title for item in wanted_there(plain, ROBOT, VIEWER, None)]


@pytest.mark.parametrize("robot", [ROBOT, WantedRobot("yes", "stage"), WantedRobot("007", "1e3")])
def test_robot_file_is_read_back_as_it_was_meant(robot: WantedRobot, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(robot_file(robot))
    assert load_robot_file(tmp_path / "robot.yaml") == RobotFile(robot.name, robot.base, robot.variant)


def test_robot_file_keeps_what_it_says_beside_name_and_base() -> None:
    devices = "devices:\n  lidar: /dev/ttyUSB0\n"
    before = robot_file(WantedRobot("old", "loki", "big")) + devices
    after = robot_file(ROBOT, before)
    assert after == robot_file(ROBOT) + devices
    assert robot_file(ROBOT, after) == after
    assert robot_file(WantedRobot("bob", "magni"), after) == robot_file(WantedRobot("bob", "magni")) + devices


def test_master_is_started_at_boot_unless_it_is_not_wanted() -> None:
    def titles(robot: WantedRobot) -> list[str]:
        return [item.title for item in wanted_there(FACTS, robot, VIEWER, None)]

    assert {"ROS master at boot", "ROS master"} <= set(titles(ROBOT))
    assert not {"ROS master at boot", "ROS master"} & set(titles(replace(ROBOT, master=False)))


def test_announcement_is_what_avahi_reads() -> None:
    group = ET.fromstring(announcement(ROBOT, "ros"))
    assert [record.text for record in group.iter("txt-record")] == [
        "name=bob",
        "base=magni",
        "variant=lidar",
        "user=ros",
        f"version={version('ubiquity-launches')}",
    ]
    assert group.findtext("service/type") == "_ubiquity-robot._tcp"


@pytest.mark.parametrize(
    ("name", "good"),
    [("bob", True), ("r2-d2", True), ("Bob", False), ("-bob", False), ("a.b", False), ("", False), ("x" * 64, False)],
)
def test_robot_name_is_one_label_in_lower_case(name: str, good: bool) -> None:
    assert is_robot_name(name) is good


@pytest.mark.parametrize(
    ("readings", "offset"), [((10.0, 10.1, 10.2), 0.0), ((10.0, 15.1, 10.2), 4.9), ((10.0, 5.0, 10.2), -5.0)]
)
def test_clock_offset_is_what_the_time_of_asking_cannot_explain(readings: tuple[float, ...], offset: float) -> None:
    assert clock_offset(*readings) == pytest.approx(offset)
