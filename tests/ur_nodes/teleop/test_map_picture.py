from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ur_nodes.teleop.map_picture import draw_map, draw_overlay, index_grid, place_glyphs
from ur_nodes.teleop.navigator import GoalReport, GoalState, MapGrid, Place, Snapshot
from ur_nodes.teleop.palette import DARK
from ur_nodes.teleop.viewport import Viewport


def grid(cells: list[list[int]], resolution: float = 1.0, origin: Place = Place(0, 0, 0)) -> MapGrid:  # noqa: B008 - a tuple
    return MapGrid(np.array(cells[::-1], dtype=np.int8), resolution, origin)  # written with the top row first


def test_map_is_drawn_upright_one_pixel_per_cell() -> None:
    picture = draw_map(index_grid(grid([[0, 100], [-1, 0]])), Viewport(1.0, 1.0, 1.0, 2, 2), DARK)
    assert picture.tolist() == [[list(DARK.free), list(DARK.wall)], [list(DARK.unknown), list(DARK.free)]]


def test_outside_of_the_map_is_unknown() -> None:
    picture = draw_map(index_grid(grid([[0]])), Viewport(0.5, 0.5, 1.0, 3, 3), DARK)
    assert picture[1, 1].tolist() == list(DARK.free)
    assert picture[0, 1].tolist() == list(DARK.unknown)


def test_closer_view_repeats_cells_exactly() -> None:
    picture = draw_map(index_grid(grid([[0, 100], [100, 0]])), Viewport(1.0, 1.0, 0.25, 8, 8), DARK)
    assert (picture[:4, 4:] == DARK.wall).all()
    assert (picture[:4, :4] == DARK.free).all()


def test_wall_thinner_than_a_pixel_is_still_seen() -> None:
    cells = np.zeros((40, 40), np.int8)
    cells[:, 20:22] = 100
    picture = draw_map(index_grid(MapGrid(cells, 0.05, Place(0, 0, 0))), Viewport(1.0, 1.0, 0.4, 5, 5), DARK)
    assert (picture.max(axis=1)[:, 0] > 150).all()


def test_turned_map_is_drawn_turned() -> None:
    turned = grid([[100, 0, 0]], origin=Place(0, 0, math.pi / 2))  # its x axis is the map's y axis
    picture = draw_map(index_grid(turned), Viewport(-0.5, 1.5, 1.0, 1, 3), DARK)
    assert picture[2, 0].tolist() == list(DARK.wall)
    assert picture[0, 0].tolist() == list(DARK.free)


def test_no_map_is_all_unknown() -> None:
    assert (draw_map(None, Viewport(0, 0, 1, 4, 2), DARK) == DARK.unknown).all()


def test_scan_and_path_are_drawn_and_clipped() -> None:
    view = Viewport(0.0, 0.0, 1.0, 10, 10)
    base = draw_map(None, view, DARK)
    snapshot = Snapshot(scan=np.array([[2.5, 2.5], [99.0, 0.0]]), path=np.array([[-20.0, -2.5], [20.0, -2.5]]))
    picture = draw_overlay(base, snapshot, view, DARK)
    assert picture[2, 7].tolist() == list(DARK.scan)
    assert (picture[7] == DARK.path).all()
    assert (base == DARK.unknown).all()


def test_robot_close_by_is_drawn_to_scale() -> None:
    view = Viewport(0.0, 0.0, 0.02, 60, 60)
    snapshot = Snapshot(pose=Place(0.0, 0.0, 0.0))
    picture = draw_overlay(draw_map(None, view, DARK), snapshot, view, DARK)
    rows, columns = np.nonzero((picture == DARK.robot).all(axis=2))
    assert columns.max() - columns.min() == pytest.approx(0.45 / 0.02, abs=2)
    assert rows.max() - rows.min() == pytest.approx(0.45 / 0.02, abs=2)
    assert picture[30, 36].tolist() == list(DARK.ink)  # the stripe is on the side of x
    assert picture[30, 24].tolist() == list(DARK.robot)
    assert not place_glyphs(snapshot, {}, None, view, DARK)


def test_robot_and_goal_are_arrows_from_afar() -> None:
    view = Viewport(0.0, 0.0, 0.5, 20, 20)
    goal = GoalReport(1, Place(2.0, 0.0, math.pi / 2), GoalState.DRIVING)
    snapshot = Snapshot(pose=Place(0.1, -0.1, math.pi), goal=goal)
    glyphs = place_glyphs(snapshot, {}, None, view, DARK)
    assert [(g.column, g.row, g.text) for g in glyphs] == [(14, 5, "↑"), (10, 5, "←")]
    over = replace(snapshot, goal=replace(goal, state=GoalState.REACHED))
    assert [g.text for g in place_glyphs(over, {}, None, view, DARK)] == ["←"]


def test_waypoint_names_are_cut_at_the_edge() -> None:
    view = Viewport(0.0, 0.0, 1.0, 10, 10)
    glyphs = place_glyphs(Snapshot(), {"kitchen": Place(2.0, 0.0, 0.0)}, None, view, DARK)
    assert "".join(g.text for g in glyphs) == "•ki"
    assert not place_glyphs(Snapshot(), {"far": Place(50.0, 0.0, 0.0)}, None, view, DARK)
