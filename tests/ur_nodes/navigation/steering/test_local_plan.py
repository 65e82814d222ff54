import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.ur_nodes.navigation.closed_loop import LIMITS, STAGE

from ur_nodes.costmap.costmap import LETHAL, Costmap
from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.planning.path_geometry import nearest_index, resample
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles, without_points
from ur_nodes.navigation.steering.local_plan import follow_reference, slow_beside, sweep_is_free
from ur_nodes.navigation.steering.rollout import FollowSettings, RolloutState, follow_settings, make_reference
from ur_nodes.navigation.steering.speed_profile import SpeedLimits, speed_profile, turn_rate

FOOTPRINT = footprint_of_outline(STAGE, 0.05, 0.01)
CORNER = resample(np.array([(0.0, 0.0), (1.5, 0.0), (1.5, 1.5)]), 0.05)


def window(*boxes: tuple[float, float, float]) -> Costmap:
    """6 m x 6 m round (1, 0) with square boxes (x, y, side)."""
    costmap = Costmap(np.zeros((120, 120), np.uint8), 0.05, Pose2(-2.0, -3.0, 0.0))
    centres = costmap.points_of_cells(np.moveaxis(np.indices((120, 120)), 0, -1))
    for x, y, side in boxes:
        costmap.costs[(abs(centres - (x, y)) < side / 2).all(axis=-1)] = LETHAL
    return costmap


@settings(max_examples=60)
@given(
    st.floats(-0.3, 1.8),
    st.floats(-0.4, 1.8),
    st.floats(-math.pi, math.pi),
    st.floats(0.0, 0.5),
    st.floats(-1.0, 1.0),
)
def test_follow_way_obeys_limits_from_any_state(x: float, y: float, yaw: float, speed: float, turn: float) -> None:
    reference = make_reference(CORNER, LIMITS)
    motion = RolloutState(Pose2(x, y, yaw), speed, turn)
    index = nearest_index(reference.points, x, y, 0, reference.end + 1)
    step = follow_reference(
        reference, index, motion, LocalObstacles(window((0.8, 0.6, 0.3))), FOOTPRINT, LIMITS, FollowSettings(), 0.1
    )
    assert 0.0 <= step.speed <= LIMITS.speed + 1e-9
    assert abs(step.turn) <= LIMITS.turn + 1e-9
    assert abs(step.speed - speed) <= LIMITS.acceleration * 0.1 + 1e-9
    assert abs(step.turn - turn) <= LIMITS.turn_acceleration * 0.1 + 1e-9


def test_follow_way_drives_at_full_speed_along_a_straight_way() -> None:
    reference = make_reference(resample(np.array([(0.0, 0.0), (4.0, 0.0)]), 0.05), LIMITS)
    step = follow_reference(
        reference,
        10,
        RolloutState(Pose2(0.5, 0.0, 0.0), 0.5, 0.0),
        LocalObstacles(window()),
        FOOTPRINT,
        LIMITS,
        FollowSettings(),
        0.1,
    )
    assert step.speed > 0.499
    assert abs(step.turn) < 0.01


def test_follow_way_turns_on_the_spot_when_the_way_is_behind() -> None:
    reference = make_reference(resample(np.array([(0.0, 0.0), (4.0, 0.0)]), 0.05), LIMITS)
    step = follow_reference(
        reference,
        0,
        RolloutState(Pose2(0.0, 0.0, 3.0), 0.0, 0.0),
        LocalObstacles(window()),
        FOOTPRINT,
        LIMITS,
        FollowSettings(),
        0.1,
    )
    assert step.speed == 0.0
    assert step.turn < -0.2


def test_follow_way_slows_down_before_an_obstacle_and_stops_where_nothing_helps() -> None:
    reference = make_reference(resample(np.array([(0.0, 0.0), (4.0, 0.0)]), 0.05), LIMITS)
    wall = window(*((1.2, y, 0.2) for y in np.arange(-1.0, 1.1, 0.1)))
    moving = RolloutState(Pose2(0.4, 0.0, 0.0), 0.5, 0.0)
    step = follow_reference(reference, 8, moving, LocalObstacles(wall), FOOTPRINT, LIMITS, FollowSettings(), 0.1)
    assert step.hindered
    assert step.speed < 0.5
    near = RolloutState(Pose2(0.87, 0.0, 0.0), 0.0, 0.0)
    assert follow_reference(reference, 17, near, LocalObstacles(wall), FOOTPRINT, LIMITS, FollowSettings(), 0.1).blocked


def test_follow_way_never_foresees_a_touch() -> None:
    reference = make_reference(CORNER, LIMITS)
    costmap = window((0.9, 0.3, 0.2), (1.9, 0.6, 0.2))
    motion = RolloutState(Pose2(0.2, 0.0, 0.0), 0.3, 0.0)
    step = follow_reference(reference, 4, motion, LocalObstacles(costmap), FOOTPRINT, LIMITS, FollowSettings(), 0.1)
    for x, y, yaw in step.ahead:
        c, s = math.cos(yaw), math.sin(yaw)
        points = FOOTPRINT.samples @ np.array(((c, s), (-s, c))) + (x, y)
        assert not (costmap.costs_at(points) == LETHAL).any()


def test_sweep_is_free_lets_a_robot_leave_what_it_touches() -> None:
    costmap = window((0.26, 0.0, 0.2))
    touching = Pose2(0.0, 0.0, 0.0)
    assert not sweep_is_free(RolloutState(touching, 0.2, 0.0), 0.5, LocalObstacles(costmap), FOOTPRINT)
    assert sweep_is_free(RolloutState(touching, -0.2, 0.0), 0.5, LocalObstacles(costmap), FOOTPRINT)


def test_speed_profile_ends_at_rest_and_can_be_braked() -> None:
    speeds = speed_profile(CORNER, LIMITS)
    assert speeds[-1] == 0.0
    assert speeds.max() <= LIMITS.speed + 1e-9
    braking = (speeds[:-1] ** 2 - speeds[1:] ** 2) / (2 * 0.05)
    assert braking.max() <= LIMITS.acceleration + 1e-6


def test_turn_rate_can_be_braked_from_any_error() -> None:
    for error in np.linspace(-3.0, 3.0, 61):
        rate = turn_rate(float(error), LIMITS)
        assert rate**2 / (2 * LIMITS.turn_acceleration) <= abs(error) + 1e-9
        assert rate * error >= 0.0


def test_points_of_the_scan_are_more_exact_than_cells() -> None:
    side = float(FOOTPRINT.outline[:, 1].max())
    along = np.arange(0.4, 2.0, 0.05)
    walls = np.concatenate([np.column_stack((along, np.full(len(along), y))) for y in (side + 0.03, -side - 0.01)])
    costmap = window()
    cells = costmap.cells_of_points(walls)
    costmap.costs[cells[:, 0], cells[:, 1]] = LETHAL
    here = RolloutState(Pose2(0.0, 0.01, 0.0), 0.3, 0.0)
    rough, exact = LocalObstacles(costmap), LocalObstacles(costmap, scan=walls)
    assert not sweep_is_free(here, 1.0, rough, FOOTPRINT)
    assert sweep_is_free(here, 1.0, exact, FOOTPRINT)
    assert not sweep_is_free(replace(here, turn=0.15), 1.0, exact, FOOTPRINT)
    reference = make_reference(resample(np.array([(0.0, 0.01), (2.0, 0.01)]), 0.05), LIMITS)
    before = RolloutState(Pose2(0.24, 0.01, 0.0), 0.0, 0.0)
    for around, blocked in ((rough, True), (exact, False)):
        step = follow_reference(reference, 5, before, around, FOOTPRINT, LIMITS, FollowSettings(), 0.1)
        assert step.blocked == blocked


def test_obstacles_that_the_scan_does_not_show_stay() -> None:
    costmap = window((1.0, 0.0, 0.2), (-1.0, 0.0, 0.2))
    seen = without_points(costmap, np.array([(1.0 + dx, dy) for dx in (-0.05, 0.05) for dy in (-0.05, 0.05)]))
    assert seen.costs_at(np.array((1.0, 0.0))) != LETHAL
    assert seen.costs_at(np.array((-1.0, 0.0))) == LETHAL


def test_fast_robot_slows_where_it_only_just_passes_and_in_time_before() -> None:
    fast = replace(LIMITS, speed=2.0)
    reference = make_reference(resample(np.array([(0.0, 0.0), (4.0, 0.0)]), 0.05), fast)
    door = window((2.0, 0.55, 0.5), (2.0, -0.55, 0.5))
    slowed = slow_beside(reference, 0, door, FOOTPRINT, fast)
    through = np.hypot(*(reference.points - (2.0, 0.0)).T).argmin()
    assert slowed.speeds[through] < 0.9
    assert slowed.speeds[0] > slowed.speeds[through]
    steps = np.diff(slowed.speeds[: through + 1] ** 2)
    assert (steps >= -2.0 * 0.85 * fast.acceleration * reference.spacing - 1e-9).all(), "it cannot brake so hard"
    assert (slow_beside(reference, 0, window(), FOOTPRINT, fast).speeds == reference.speeds).all()


def test_follow_settings_of_the_usual_bases_are_the_usual_ones() -> None:
    assert follow_settings(LIMITS) == FollowSettings()
    fast = follow_settings(replace(LIMITS, speed=2.0))
    assert fast.horizon > 2.0 / LIMITS.acceleration
    assert fast.preview_most > FollowSettings().preview_most


@pytest.mark.parametrize("speed", [1.0, 2.0, 3.0])
def test_fast_base_that_begins_across_its_path_does_not_weave(speed: float) -> None:
    limits = SpeedLimits(speed, 2.0, 0.8, 2.5)
    reference = make_reference(resample(np.array([(0.0, 0.0), (4.0, 0.0)]), 0.05), limits)
    motion, index, aside = RolloutState(Pose2(0.0, 0.0, -2.1), 0.0, 0.0), 0, []
    for _ in range(60):
        step = follow_reference(
            reference, index, motion, LocalObstacles(window()), FOOTPRINT, limits, follow_settings(limits), 0.1
        )
        pose, yaw = motion.pose, motion.pose.yaw + 0.05 * step.turn
        way = 0.1 * step.speed
        after = Pose2(pose.x + way * math.cos(yaw), pose.y + way * math.sin(yaw), pose.yaw + 0.1 * step.turn)
        motion = RolloutState(after, step.speed, step.turn)
        index = nearest_index(reference.points, after.x, after.y, index, reference.end + 1)
        aside.append(after.y)
    assert max(map(abs, aside)) < 0.15
    assert abs(motion.pose.yaw) < 0.2
    assert motion.pose.x > 2.0


def test_slow_start_of_a_fast_base_is_not_hindered_by_what_it_would_touch_only_at_full_speed() -> None:
    limits = replace(LIMITS, speed=3.0)
    settings = follow_settings(limits)
    reference = make_reference(resample(np.array([(0.0, 0.0), (4.0, 0.0)]), 0.05), limits)
    around = LocalObstacles(window((3.2, 0.0, 0.3)))
    begin, late = (RolloutState(Pose2(0.0, 0.0, 0.0), speed, 0.0) for speed in (0.5, 1.8))
    first, last = (
        follow_reference(reference, 0, motion, around, FOOTPRINT, limits, settings, 0.1) for motion in (begin, late)
    )
    assert not first.hindered
    assert first.speed > 0.5
    assert last.hindered or last.blocked
    assert last.speed < 1.8
