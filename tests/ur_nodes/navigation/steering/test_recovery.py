import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from tests.ur_nodes.navigation.closed_loop import LIMITS, STAGE

from ur_nodes.costmap.costmap import LETHAL, Costmap
from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.local_plan import sweep_is_free
from ur_nodes.navigation.steering.recovery import SEQUENCE, Behaviour, Recovery, find_escape, move_to_recover
from ur_nodes.navigation.steering.rollout import RolloutState

FOOTPRINT = footprint_of_outline(STAGE, 0.05, 0.01)


def window(*rows_columns: tuple[slice, slice]) -> Costmap:
    costs = np.zeros((80, 80), np.uint8)
    for box in rows_columns:
        costs[box] = LETHAL
    return Costmap(costs, 0.05, Pose2(-2.0, -2.0, 0.0))


def play(
    behaviour: Behaviour, costmap: Costmap, scan: NDArray[np.float64] | None = None
) -> tuple[RolloutState, float, float]:
    """The last motion, how far it turned and how far it went, of a behaviour played to its end."""
    around = LocalObstacles(costmap) if scan is None else LocalObstacles(costmap, scan=scan)
    recovery = Recovery(SEQUENCE.index(behaviour))
    motion, turned, went = RolloutState(Pose2(0.0, 0.0, 0.0), 0.0, 0.0), 0.0, 0.0
    for _ in range(400):
        move = move_to_recover(recovery, motion, around, FOOTPRINT, LIMITS, 0.1)
        recovery = move.recovery
        if move.finished:
            return motion, turned, went
        speed, turn, _ = move.command
        x, y, yaw = motion.pose
        pose = Pose2(x + 0.1 * speed * math.cos(yaw), y + 0.1 * speed * math.sin(yaw), wrap_angle(yaw + 0.1 * turn))
        turned, went = turned + 0.1 * abs(turn), went + 0.1 * abs(speed)
        motion = RolloutState(pose, speed, turn)
    raise AssertionError(f"{behaviour} does not end")


def test_rotate_turns_once_round() -> None:
    _, turned, went = play(Behaviour.ROTATE, window())
    assert 6.2 < turned < 6.6
    assert went == 0.0


def test_rotate_ends_where_there_is_no_room_to_turn() -> None:
    walls = window((slice(44, 46), slice(0, 80)), (slice(34, 36), slice(0, 80)))
    _, turned, _ = play(Behaviour.ROTATE, walls)
    assert turned < 0.5


def test_robot_that_cannot_turn_on_the_spot_does_not_turn_round_and_backs_off_in_bends_it_can_drive() -> None:
    limits = replace(LIMITS, radius=0.9)
    here = RolloutState(Pose2(0.0, 0.0, 0.0), 0.0, 0.0)
    costmap = LocalObstacles(window((slice(30, 50), slice(45, 47))))
    turning = Recovery(SEQUENCE.index(Behaviour.ROTATE))
    assert move_to_recover(turning, here, costmap, FOOTPRINT, limits, 0.1).finished
    speed, turn, _ = find_escape(here, costmap, FOOTPRINT, limits)
    assert speed < 0.0
    assert abs(turn) <= abs(speed) / 0.9


def test_back_off_goes_back_and_stays_in_reach() -> None:
    motion, _, went = play(Behaviour.BACK_OFF, window((slice(30, 50), slice(45, 47))))
    assert 0.25 < went < 0.4
    assert motion.pose.x < -0.2


def test_back_off_does_not_run_into_what_is_behind() -> None:
    motion, _, _ = play(Behaviour.BACK_OFF, window((slice(30, 50), slice(45, 47)), (slice(30, 50), slice(33, 34))))
    assert motion.pose.x > -0.16


def test_back_off_leaves_a_wall_beside_the_robot_until_it_can_turn() -> None:
    along = np.arange(-1.9, 1.9, 0.04)
    wall = np.column_stack((along, np.full(len(along), FOOTPRINT.outline[:, 1].max() + 0.04)))
    costmap = window()
    costmap.costs[tuple(costmap.cells_of_points(wall).T)] = LETHAL
    around = LocalObstacles(costmap, scan=wall)
    turning = RolloutState(Pose2(0.0, 0.0, 0.0), 0.0, LIMITS.turn)
    assert not sweep_is_free(turning, math.tau / LIMITS.turn, around, FOOTPRINT)
    motion, _, went = play(Behaviour.BACK_OFF, costmap, wall)
    assert 0.3 <= went < 0.9
    assert sweep_is_free(replace(turning, pose=motion.pose), math.tau / LIMITS.turn, around, FOOTPRINT)


def test_find_way_out_goes_ahead_when_something_is_close_behind() -> None:
    speed, _, _ = find_escape(
        RolloutState(Pose2(0.0, 0.0, 0.0), 0.0, 0.0),
        LocalObstacles(window((slice(30, 50), slice(34, 36)))),
        FOOTPRINT,
        LIMITS,
    )
    assert speed > 0.0


def test_robot_that_drives_sideways_leaves_a_corner_to_its_free_side() -> None:
    here = RolloutState(Pose2(0.0, 0.0, 0.0), 0.0, 0.0)
    walls = window((slice(30, 36), slice(30, 50)), (slice(30, 50), slice(45, 47)), (slice(30, 50), slice(33, 35)))
    speed, turn, left = find_escape(here, LocalObstacles(walls), FOOTPRINT, replace(LIMITS, lateral=0.3))
    assert left > 0.0
    assert (speed, turn) == (0.0, 0.0)


def test_recovery_begins_anew_once_the_robot_has_come_away() -> None:
    stuck = Recovery(3, began=Pose2(0.0, 0.0, 0.0))
    assert stuck.forgotten(Pose2(0.3, 0.0, 0.0), 0.5).tried == 3
    assert stuck.forgotten(Pose2(0.6, 0.0, 0.0), 0.5).tried == 0


def test_recovery_runs_out_of_behaviours() -> None:
    assert [Recovery(n).behaviour for n in range(len(SEQUENCE) + 1)] == [*SEQUENCE, None]
