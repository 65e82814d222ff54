"""Two computers side by side, as people read it."""

from dataclasses import replace

from tests.robot.doctor.pairs import NOBODY, PAIR, ROBOT, WIFI
from tests.robot.doctor.rules.ros2.cases import RUNNING

from ur.robot.doctor.findings import AdvertisedNode
from ur.robot.doctor.side import Side
from ur.robot.doctor.summary import describe_ros2, summarize


def test_everything_that_was_seen_is_shown_for_both() -> None:
    pair = replace(
        PAIR,
        offset=0.25,
        remote=replace(ROBOT, wifi=(WIFI,), ur="0.1.0"),
        advertised=(AdvertisedNode("/x", "nobody", NOBODY, NOBODY),),
    )
    rows = {what: cells for what, *cells in summarize(pair)}
    assert rows["computer"] == ["pat@laptop", "ros@bob"]
    assert rows["clock"] == ["", "+0.250 s"]
    assert rows["WiFi"] == ["none", "wlan0 5 GHz -50 dBm 400 Mbit/s"]
    assert rows["full frames"] == ["yes (wlan0, MTU 1500)"] * 2
    assert rows["set up by ur"] == ["", "0.1.0"]
    assert rows["node /x at nobody"] == ["nothing", "nothing"]


def test_ros2_of_a_computer_is_described() -> None:
    assert describe_ros2(RUNNING) == [
        "ROS 2 Jazzy in /opt/ros/jazzy, supported until May 2029",
        "2 processes of ROS 2 in domain 7, rmw_fastrtps_cpp (base.service, lidar.service)",
        "4 nodes, 3 topics",
    ]


def test_what_was_not_seen_is_shown_as_such() -> None:
    rows = {what: cells for what, *cells in summarize(replace(PAIR, remote=Side("bob")))}
    assert (rows["latency"][1], rows["loss"][1], rows["memory"][1]) == ("", "", "")
    assert rows["the other's name means"][1] == "nothing"
