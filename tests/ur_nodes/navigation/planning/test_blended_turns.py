import math

import numpy as np
import pytest

from ur_nodes.costmap.costmap import FREE, LETHAL, Costmap
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.planning.blended_turns import blend_turns
from ur_nodes.navigation.planning.global_plan import PlanSettings, traversal_weights
from ur_nodes.navigation.planning.path_geometry import Points, arc_lengths, curvatures, headings, resample

BEND, ROOM = 0.55, 0.3
STRAIGHT = np.stack((np.arange(0.0, 6.01, 0.05), np.zeros(121)), axis=-1)
WEIGHTS = traversal_weights(PlanSettings())


def floor(wall: float | None = None) -> Costmap:
    """Free floor from (-2, -4) to (8, 4), with a wall along x at `wall` m."""
    costs = np.full((160, 200), FREE, np.uint8)
    if wall is not None:
        costs[round((wall + 4.0) / 0.05)] = LETHAL
    return Costmap(costs, 0.05, Pose2(-2.0, -4.0, 0.0))


def blended(yaw: float, heading: float | None, costmap: Costmap | None = None) -> Points:
    return resample(blend_turns(STRAIGHT, yaw, heading, BEND, ROOM, costmap or floor(), WEIGHTS), 0.05)


@pytest.mark.parametrize("heading", [1.0, -1.0, 2.0, math.pi])
def test_path_turns_towards_the_heading_of_the_goal_and_ends_at_it(heading: float) -> None:
    path = blended(0.0, heading)
    left = abs(wrap_angle(heading - float(headings(path)[-1])))
    assert left < max(0.3, abs(heading) - 0.7)
    assert path[-1] == pytest.approx(STRAIGHT[-1])
    assert path[0] == pytest.approx(STRAIGHT[0])
    saved = (abs(heading) - left) * BEND
    assert arc_lengths(path)[-1] - 6.0 < saved / 2.0, "the way that it is longer costs less than the turn"


def test_bends_are_no_narrower_than_the_robot_drives_at_speed_but_where_it_brakes() -> None:
    path = blended(0.0, 1.5)
    before_end = arc_lengths(path) < arc_lengths(path)[-1] - 0.4
    assert abs(curvatures(path)[before_end]).max() < 1.1 / BEND


@pytest.mark.parametrize("yaw", [1.0, -2.5])
def test_path_leaves_nearer_to_the_heading_of_the_robot(yaw: float) -> None:
    path = blended(yaw, 0.0)
    assert abs(wrap_angle(yaw - float(headings(path)[0]))) < abs(yaw) - 0.6
    assert path[-1] == pytest.approx(STRAIGHT[-1])


def test_path_keeps_its_end_where_any_heading_counts_or_it_has_that_heading() -> None:
    assert (blend_turns(STRAIGHT, 0.0, None, BEND, ROOM, floor(), WEIGHTS) == STRAIGHT).all()
    assert (blend_turns(STRAIGHT, 0.1, -0.1, BEND, ROOM, floor(), WEIGHTS) == STRAIGHT).all()


def test_bend_keeps_the_room_that_a_turn_on_the_spot_needs() -> None:
    free, beside = blended(0.0, math.pi / 2.0), blended(0.0, math.pi / 2.0, floor(-0.35))
    assert free[:, 1].min() < -0.1, "it swings out"
    assert beside[:, 1].min() > -0.06
    between = blended(0.0, math.pi / 2.0, floor(-0.2))
    assert between[-20:, 1].min() >= -1e-6, "no nearer than the goal is"


def test_short_path_stays_within_its_ends() -> None:
    path = blend_turns(STRAIGHT[:5], 0.0, 2.0, BEND, ROOM, floor(), WEIGHTS)
    assert path[-1] == pytest.approx(STRAIGHT[4])
    assert path[0] == pytest.approx(STRAIGHT[0])
