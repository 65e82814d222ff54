import re

import numpy as np

from ur.source.ansi import strip_styles
from ur_nodes.client.snapshot import RobotSnapshot
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.map_feed import Zoom, draw_map_lines, follow, prepare_map, press_zoom


def room(width: float, height: float) -> Grid:
    """A room with walls, in the middle of a larger grid of unknown space."""
    values = np.full((round(height / 0.05) + 40, round(width / 0.05) + 40), -1, np.int8)
    values[20:-20, 20:-20] = 100
    values[22:-22, 22:-22] = 0
    return Grid(values, 0.05, Pose2(-1.0, -1.0, 0.0))


def test_small_map_is_shown_whole_and_letters_do_without_colours() -> None:
    growing, robot = prepare_map(room(6.0, 3.0)), RobotSnapshot(pose=Pose2(1.0, 1.0, 0.0))
    view = follow(None, growing, robot, 60, 20)
    lines = draw_map_lines(growing, robot, view, colour=False)
    assert len(lines) == 20
    assert {len(line) for line in lines} == {60}
    walls = [line for line in lines if line.count("#") > 40]
    assert len(walls) in (2, 3, 4)  # a wall may lie in two lines
    assert sum("→" in line for line in lines) == 1
    assert any("┤ " in line for line in lines)  # the scale
    coloured = draw_map_lines(growing, robot, view, colour=True)
    assert [len(strip_styles(line)) for line in coloured] == [60] * 20
    assert all(re.search(r"\x1b\[38;5;\d+;48;5;\d+m", line) for line in coloured)


def test_large_map_follows_the_robot_which_may_move_in_the_middle() -> None:
    growing = prepare_map(room(60.0, 40.0))
    first = follow(None, growing, RobotSnapshot(pose=Pose2(5.0, 5.0, 0.0)), 80, 20)
    assert (first.x, first.y) == (5.0, 5.0)
    assert follow(first, growing, RobotSnapshot(pose=Pose2(6.0, 5.2, 0.0)), 80, 20) == first
    moved = follow(first, growing, RobotSnapshot(pose=Pose2(9.5, 5.0, 0.0)), 80, 20)
    assert (moved.x, moved.scale) == (9.5, first.scale)
    assert (
        follow(moved, growing, RobotSnapshot(pose=Pose2(9.5, 5.0, 0.0)), 50, 30).width == 50
    )  # a new size of the terminal


def test_nothing_known_shows_the_surroundings_of_the_begin() -> None:
    view = follow(None, None, RobotSnapshot(), 40, 10)
    assert draw_map_lines(None, RobotSnapshot(), view, colour=False)[0] == " " * 40
    nothing = prepare_map(Grid(np.full((4, 4), -1, np.int8), 0.05, Pose2(0.0, 0.0, 0.0)))
    assert follow(None, nothing, RobotSnapshot(), 40, 10) == view


def test_keys_show_the_whole_of_a_large_map_or_a_scale_of_the_persons_choice() -> None:
    growing, robot = prepare_map(room(60.0, 40.0)), RobotSnapshot(pose=Pose2(5.0, 5.0, 0.0))
    near = follow(None, growing, robot, 80, 20)
    whole = follow(near, growing, robot, 80, 20, Zoom.WHOLE)
    column, row = whole.to_pixel(60.0, 40.0)
    assert 0 <= column <= 80
    assert 0 <= row <= 40
    closer = press_zoom(Zoom.AUTOMATIC, "+", near)
    assert isinstance(closer, float)
    assert follow(near, growing, robot, 80, 20, closer).scale == closer < near.scale
    assert press_zoom(closer, "0", near) is Zoom.WHOLE
    assert press_zoom(closer, "f", near) is Zoom.AUTOMATIC
    assert press_zoom(closer, "s", near) is None
