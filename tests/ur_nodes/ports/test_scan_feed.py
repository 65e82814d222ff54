from __future__ import annotations

import math

import numpy as np
import pytest

from ur_nodes.memory.bus import Bus
from ur_nodes.ports.node import SECOND
from ur_nodes.ports.scan_feed import LONGEST_TURN, ScanFeed, at_its_middle
from ur_nodes.ports.values import Scan


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
