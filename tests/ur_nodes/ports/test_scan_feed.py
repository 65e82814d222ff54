import math

import numpy as np
import pytest

from ur_nodes.geometry.pose import Pose3
from ur_nodes.geometry.scan_time import LONGEST_TURN
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.node import SECOND
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.scan_feed import ScanFeed, at_its_middle
from ur_nodes.ports.values import Scan, Transform


def scan(increment: float, stamp: int = 10 * SECOND) -> Scan:
    return Scan(stamp, "laser", -math.pi, 0.01, 0.1, 12.0, np.ones(101, np.float32), time_increment=increment)


@pytest.mark.parametrize(("increment", "seconds"), [(0.002, 10.1), (-0.002, 9.9), (0.0, 10.0)])
def test_time_of_a_scan_is_the_middle_of_its_turn_in_either_direction(increment: float, seconds: float) -> None:
    assert at_its_middle(scan(increment)).stamp == round(seconds * SECOND)


@pytest.mark.parametrize("increment", [math.nan, math.inf, -math.inf, LONGEST_TURN / 99.0, 1e300])
def test_time_between_beams_that_no_lidar_has_moves_no_scan(increment: float) -> None:
    assert at_its_middle(scan(increment)).stamp == 10 * SECOND


def test_scan_is_given_with_the_odometry_of_its_middle() -> None:
    bus = Bus()
    used: list[Scan] = []
    ScanFeed(bus.node("user"), "", "base", lambda each, _: used.append(each))
    bus.node("lidar").publish("scan", Scan).send(scan(-0.002))
    bus.run(0.1)
    assert [each.stamp for each in used] == [round(9.9 * SECOND)]


@pytest.mark.parametrize("ends", [10.2, 10.12])  # the odometry of the last beam may be on its way
def test_scan_of_a_robot_that_moves_is_given_as_if_measured_at_once(ends: float) -> None:
    bus = Bus()
    used: list[Scan] = []
    driver = bus.node("driver")
    driver.transforms.send(Transform(0, "base", "laser", Pose3(0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0), fixed=True))
    ScanFeed(bus.node("user"), "odom", "base", lambda each, _: used.append(each))
    bus.run(0.1)
    for seconds in (10.0, 10.04, 10.08, 10.12, 10.16, 10.2):
        if seconds <= ends:
            pose = Pose3(seconds - 10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)  # 1 m/s
            driver.publish("/tf", tuple, Quality.EVERY).send(
                (Transform(round(seconds * SECOND), "odom", "base", pose),)
            )
    bus.node("lidar").publish("scan", Scan).send(scan(0.002))
    bus.run(0.5)
    (given,) = used
    assert given.ranges[0] == pytest.approx(1.1, abs=0.002)  # the first beam looks back, 0.1 s before the middle
    assert given.ranges[50] == pytest.approx(1.0, abs=0.002)
    assert given.time_increment == 0.0


def test_missing_mount_is_reported_once_its_node_has_had_time_to_start() -> None:
    bus = Bus()
    user = bus.node("user")
    feed = ScanFeed(user, "", "base", lambda _scan, _odometry: None)

    def look() -> None:
        feed.mount("laser")

    user.every(0.5, look)
    bus.run(9.0)
    assert user.lines == []
    bus.run(3.0)
    assert user.lines == [("warn", "no transform from laser to base, expected one")]


def test_scan_whose_odometry_does_not_come_is_given_as_it_is_where_patience_ends() -> None:
    bus = Bus()
    used: list[Scan] = []
    driver = bus.node("driver")
    ScanFeed(bus.node("user"), "odom", "base", lambda each, _: used.append(each), patience=0.3)
    bus.run(0.1)
    pose = Pose3(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    driver.publish("/tf", tuple, Quality.EVERY).send((Transform(bus.now, "odom", "base", pose),))
    bus.run(0.5)
    bus.node("lidar").publish("scan", Scan).send(scan(0.002, bus.now))
    bus.run(0.2)
    assert used == []
    bus.run(0.8)
    assert [each.time_increment for each in used] == [0.002]
