import math

import numpy as np
import pytest

from ur_nodes.costmap.costmap import LETHAL, Costmap, Inflation
from ur_nodes.costmap.layers import UsedRanges
from ur_nodes.costmap.rolling_costmap import RollingCostmap
from ur_nodes.costmap.sonar import beams_of_range, without_walls
from ur_nodes.geometry.pose import Pose2

CONE = 0.5  # rad


def test_echo_may_come_from_anywhere_on_its_arc() -> None:
    beams = beams_of_range(1.5, CONE, 0.02, 4.0)
    assert beams.angles[[0, -1]] == pytest.approx([-CONE / 2, CONE / 2])
    assert beams.hits.all()
    assert beams.ranges == pytest.approx(1.5)


@pytest.mark.parametrize("distance", [4.0, 7.0, math.inf])
def test_silence_means_that_the_cone_is_free(distance: float) -> None:
    beams = beams_of_range(distance, CONE, 0.02, 4.0)
    assert not beams.hits.any()
    assert beams.ranges == pytest.approx(4.0)


@pytest.mark.parametrize("distance", [0.01, -math.inf, math.nan])
def test_what_is_too_near_says_nothing(distance: float) -> None:
    assert not len(beams_of_range(distance, CONE, 0.02, 4.0).angles)


def test_costmap_has_what_sonars_hear_and_forgets_it_when_it_is_gone() -> None:
    costmap = RollingCostmap(4.0, 0.05, UsedRanges(2.5, 3.0), Inflation(0.1, 0.2, 10.0))
    here, sonar = Pose2(0.0, 0.0, 0.0), Pose2(0.1, 0.0, 0.0)
    costmap.update(here, sonar, beams_of_range(1.0, CONE, 0.02, 4.0))
    seen = np.argwhere(costmap.occupied().costs == LETHAL)
    assert len(seen) >= 5
    centre = costmap.occupied().costs.shape[0] // 2
    assert (seen[:, 1] > centre + 15).all()  # ahead
    costmap.update(here, sonar, beams_of_range(math.inf, CONE, 0.02, 4.0))
    assert not (costmap.occupied().costs == LETHAL).any()


@pytest.mark.parametrize(
    ("distance", "is_obstacle"),
    [(2.0, False), (1.8, False), (2.2, False), (1.0, True), (math.inf, False)],
)
def test_echo_that_a_wall_of_the_map_explains_is_no_obstacle(distance: float, is_obstacle: bool) -> None:
    costs = np.zeros((60, 80), np.uint8)
    costs[:, 60] = LETHAL  # across x, at 2 m from the sensor
    known = Costmap(costs, 0.05, Pose2(0.0, 0.0, 0.0))
    beams = without_walls(beams_of_range(distance, CONE, 0.02, 4.0), Pose2(1.0, 1.5, 0.0), known)
    assert beams.hits.any() == is_obstacle
    assert beams.ranges == pytest.approx(min(distance, 4.0))  # free as far as that, either way


def test_frames_of_a_door_do_not_close_it() -> None:
    costs = np.zeros((60, 80), np.uint8)
    costs[:20, 40] = costs[38:, 40] = LETHAL  # a door of 0.9 m, ahead and to both sides of the sensor
    known = Costmap(costs, 0.05, Pose2(0.0, 0.0, 0.0))
    for yaw in (-0.785, 0.785):
        beams = without_walls(beams_of_range(0.8, CONE, 0.02, 4.0), Pose2(1.5, 1.45, yaw), known)
        assert not beams.hits.any()
