"""A robot whose lidar takes time for a scan turns before a wall: all nodes have the wall where it is."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.ur_nodes.costmap.test_local_costmap_node import load

from ur_nodes.client.navigation import RobotState
from ur_nodes.costmap import local_costmap_node
from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.node import SECOND
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map, Scan, Transform

WALL, SPEED, TURN = 1.52, 1.5, 0.2  # m ahead of where it began, rad/s, s for a scan
COUNT = 360


def scan_of(stamp: int, clockwise: bool) -> Scan:
    """The scan of a turn that ends at a time."""
    angles = np.linspace(-math.pi, math.pi, COUNT, endpoint=False)
    spacing = -TURN / COUNT if clockwise else TURN / COUNT
    first = stamp if clockwise else stamp - round(TURN * SECOND)
    heading = angles + SPEED * (first / SECOND + spacing * np.arange(COUNT))
    ranges = np.where(np.cos(heading) > 0.3, WALL / np.maximum(np.cos(heading), 0.3), np.inf).astype(np.float32)
    return Scan(first, "laser", -math.pi, 2.0 * math.pi / COUNT, 0.1, 12.0, ranges, time_increment=spacing)


def turn_before_a_wall(bus: Bus, clockwise: bool) -> None:
    robot, lidar = bus.node("robot"), bus.node("lidar").publish("scan", Scan)
    fixed = Transform(0, "base_footprint", "laser", Pose3(0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0), fixed=True)
    robot.transforms.send(fixed)
    tf = robot.publish("/tf", tuple, Quality.EVERY)
    for tick in range(1, 151):
        pose = Pose2(0.0, 0.0, SPEED * bus.now / SECOND).in_space()
        tf.send((Transform(bus.now, "odom", "base_footprint", pose),))
        if tick % 10 == 0 and tick > 20:
            lidar.send(scan_of(bus.now, clockwise))
        bus.run(0.02)


def costmap(bus: Bus) -> Callable[[], NDArray[np.float64]]:
    bus.load_parameters("/local_costmap", load("create2.yaml"))
    local_costmap_node.start(bus.node("local_costmap"))
    grids: list[Map] = []
    bus.node("viewer").subscribe("local_costmap/costmap/costmap", Map, grids.append)
    return lambda: grids[-1].grid.points_of_cells(np.argwhere(grids[-1].grid.values == 100))


def client(bus: Bus) -> Callable[[], NDArray[np.float64]]:
    robot = RobotState(bus.node("terminal"), "map", "base_footprint")

    def points() -> NDArray[np.float64]:
        found = robot.scan(by_odometry=True)
        assert found is not None
        return found

    return points


@pytest.mark.parametrize("clockwise", [True, False])
@pytest.mark.parametrize("consumer", [costmap, client])
def test_wall_is_where_it_is_while_the_robot_turns(
    consumer: Callable[[Bus], Callable[[], NDArray[np.float64]]], clockwise: bool
) -> None:
    bus = Bus()
    points = consumer(bus)
    turn_before_a_wall(bus, clockwise)
    found = points()
    assert len(found) > 20
    assert np.abs(found[:, 0] - WALL).max() < 0.06
