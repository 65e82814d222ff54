import math

import numpy as np
import pytest
from tests.ur_nodes.exploration.drawn import ROOM, box, draw, place

from ur_nodes.exploration.explorer import Explorer
from ur_nodes.exploration.explorer_step import ExplorerInputs, ExplorerOutputs, ExplorerSettings, GoalEnd
from ur_nodes.exploration.search.choice import CornerSettings
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

NARROW = """
?????????????????
?########????????
?#......#????????
?#......########?
?#..............?
?#......########?
?#......#????????
?########????????
?????????????????
"""
KNOWN = ROOM.replace("...........?", "......#?????")
DOOR = place(8, 4.5)
SHUT = box(DOOR.x - 0.1, DOOR.y - 0.45, DOOR.x + 0.1, DOOR.y + 0.45)

CORNER = """
###########
#.........#
#.........#
#.........#
#.........?
#.........#
#.........#
#.........#
###########
"""
"""A room whose right wall has a hole of 0.4 m, which is not seen."""


class ExplorerRun:
    """An explorer with a clock: each step is a second and, unless told otherwise, a new map."""

    def __init__(self, text: str = ROOM, radius: float = 0.2, corners: CornerSettings | None = None) -> None:
        self.explorer = Explorer(ExplorerSettings(radius=radius, corners=corners or CornerSettings()))
        self.now = 0.0
        self.grid: Grid = draw(text)
        self.robot = place(3, 4)

    def step(
        self, obstacles: np.ndarray | None = None, ended: GoalEnd | None = None, paused: str = "", seconds: float = 1.0
    ) -> ExplorerOutputs:
        self.now += seconds
        inputs = ExplorerInputs(self.now, self.grid, int(self.now), self.robot, obstacles, ended, paused)
        return self.explorer.step(inputs)

    def until_the_end(self, obstacles: np.ndarray | None = None, ended: GoalEnd | None = None) -> ExplorerOutputs:
        for _ in range(120):
            out = self.step(obstacles, ended)
            if out.status.ended:
                return out
        pytest.fail("the exploration does not end")


def test_first_goal_looks_at_the_frontier_and_is_kept() -> None:
    run = ExplorerRun()
    first = run.step()
    assert first.goal is not None
    assert first.goal.x > place(6, 4).x
    assert first.status.state == "exploring"
    assert first.status.reachable == 1
    assert run.step().goal is None


def test_map_without_frontiers_is_complete_after_a_moment() -> None:
    run = ExplorerRun(KNOWN)
    assert run.step().status.state == "exploring"  # the map may not have come yet
    end = run.until_the_end()
    assert end.status.state == "complete"
    assert end.status.unreachable == ()
    assert end.goal is None


def test_frontier_that_vanishes_on_the_way_ends_its_goal() -> None:
    run = ExplorerRun()
    assert run.step().goal is not None
    run.grid = draw(KNOWN)
    out = run.step()
    assert out.cancel
    assert out.goal is None


def test_narrow_door_is_named_at_the_end() -> None:
    end = ExplorerRun(NARROW, radius=0.4).until_the_end()
    assert end.status.state == "complete"
    assert len(end.status.unreachable) == 1
    assert end.status.unreachable[0].startswith("too narrow at (3.")


def test_corner_that_hides_little_is_left_out_and_named_at_the_end() -> None:
    end = ExplorerRun(CORNER).until_the_end()
    assert end.status.state == "complete"
    assert end.status.reachable == 0
    assert end.status.corners == ("(3.98, 1.78)",)
    assert len(end.blocked) == 1


def test_corner_is_driven_to_when_all_are_asked_for() -> None:
    out = ExplorerRun(CORNER, corners=CornerSettings(left_out=0.0)).step()
    assert out.goal is not None
    assert out.status.reachable == 1
    assert out.status.corners == ()


def test_frontier_that_is_in_sight_and_stays_unseen_is_explained_by_the_narrow_door() -> None:
    end = ExplorerRun(radius=0.5).until_the_end(ended=GoalEnd(True))
    assert end.status.unreachable[0].startswith("too narrow at (3.")


def test_navigation_that_gives_up_is_tried_again_and_named_at_the_end() -> None:
    run, goals = ExplorerRun(), 0
    for _ in range(120):
        out = run.step(ended=GoalEnd(False, "no path") if goals else None)
        goals += out.goal is not None
        if out.status.ended:
            break
    assert goals == 2
    assert out.status.state == "complete"
    assert out.status.unreachable[0].endswith(": no path")


def test_frontier_that_stays_unseen_is_left_after_some_looks() -> None:
    run = ExplorerRun()
    end = run.until_the_end(ended=GoalEnd(True))
    assert end.status.unreachable == ("at (4.53, 1.62) the lidar sees nothing",)


def test_goal_without_progress_is_given_up() -> None:
    run = ExplorerRun()
    run.step()
    outputs = [run.step() for _ in range(40)]
    assert sum(out.cancel for out in outputs) == 1
    assert any("no progress for 30 s" in reason for reason in outputs[-1].status.unreachable)


def test_pause_cancels_the_goal_and_afterwards_it_goes_on() -> None:
    run = ExplorerRun()
    run.step()
    paused = run.step(paused="the keyboard drives")
    assert paused.cancel
    assert (paused.status.state, paused.status.reason) == ("paused", "the keyboard drives")
    assert not run.step(paused="the keyboard drives").cancel
    assert run.step().goal is not None


def test_door_that_closes_is_waited_for_and_its_room_explored_once_it_opens() -> None:
    run = ExplorerRun()
    assert run.step().goal is not None
    shut = run.step(SHUT)
    assert shut.cancel
    assert shut.status.unreachable[0].startswith("behind an obstacle at (3.")
    for _ in range(8):
        assert run.step(SHUT).status.state == "exploring"
    opened = run.step()
    assert opened.goal is not None
    assert opened.status.unreachable == ()


def test_door_that_stays_closed_ends_the_exploration_with_its_place() -> None:
    end = ExplorerRun().until_the_end(SHUT)
    assert end.status.state == "complete"
    assert end.status.unreachable[0].startswith("behind an obstacle at (3.")


def test_people_who_walk_about_neither_end_it_nor_are_driven_into() -> None:
    run = ExplorerRun()
    for second in range(30):
        x = place(5 + 3 * np.sin(second / 3.0), 4.5).x
        person = box(x - 0.2, DOOR.y - 0.2, x + 0.2, DOOR.y + 0.2)
        out = run.step(person)
        assert not out.status.ended
        if out.goal is not None:
            assert np.hypot(*(person - out.goal[:2]).T).min() > 0.2
    assert run.step().status.reachable == 1


def test_robot_that_does_not_fit_where_it_stands_says_so() -> None:
    run = ExplorerRun()
    around = box(run.robot.x - 0.9, run.robot.y - 0.9, run.robot.x + 0.9, run.robot.y + 0.9)
    first = run.step(around)
    assert first.clear
    end = run.until_the_end(around)
    assert end.status.state == "incomplete"
    assert "too near to an obstacle" in end.status.reason


def test_way_and_time_are_measured() -> None:
    run = ExplorerRun()
    run.step()
    run.robot = Pose2(run.robot.x + 0.5, run.robot.y, 0.0)
    status = run.step(seconds=2.0).status
    assert status.way == pytest.approx(0.5)
    assert status.seconds == 2.0


def test_time_left_is_estimated_while_the_map_grows_and_not_while_paused() -> None:
    run = ExplorerRun()
    room = run.grid
    for column in range(48, 88):  # cells of 0.05 m
        values = room.values.copy()
        values[:, column:] = -1
        run.grid = Grid(values, room.resolution, room.origin)
        status = run.step().status
        assert status.state == "exploring"
        assert (status.left is None) == (run.now <= 30.0)
    assert run.step(paused="the emergency stop is pressed").status.left is None
    assert run.step().status.left is None


def test_robot_does_not_turn_for_ever_between_a_frontier_and_one_that_only_the_other_heading_shows() -> None:
    both = "\n".join(line.replace("#...........?", "............?", 1) for line in ROOM.split("\n"))
    run = ExplorerRun(both)
    goals: list[Pose2] = []
    for _ in range(60):
        out = run.step()
        if out.goal is not None:
            goals.append(out.goal)
            bearing = math.atan2(out.goal.y - run.robot.y, out.goal.x - run.robot.x)
            run.robot = Pose2(run.robot.x, run.robot.y, bearing)
            run.grid = draw(both if out.goal.x > run.robot.x else ROOM)
    assert 1 < len(goals) < 10
