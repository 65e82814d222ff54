import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import label

from ur_nodes.client.snapshot import RobotSnapshot
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.palette import DARK, DARK_16, MapPalette
from ur_nodes.teleop.map_view.picture import Viewport, draw_map, draw_overlay, index_grid, thin_walls


def grid(cells: list[list[int]], resolution: float = 1.0, origin: Pose2 = Pose2(0, 0, 0)) -> Grid:  # noqa: B008 - a tuple
    return Grid(np.array(cells[::-1], dtype=np.int8), resolution, origin)  # written with the top row first


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
    picture = draw_map(index_grid(Grid(cells, 0.05, Pose2(0, 0, 0))), Viewport(1.0, 1.0, 0.4, 5, 5), DARK)
    assert (picture.max(axis=1)[:, 0] > 150).all()


@pytest.mark.parametrize("thickness", [1, 2])
@pytest.mark.parametrize("cells_per_pixel", [2.0, 2.5, 3.0, 4.0])
def test_thin_walls_are_one_bright_pixel_wherever_they_lie(thickness: int, cells_per_pixel: float) -> None:
    for place in range(30, 50):
        cells = np.zeros((80, 80), np.int8)
        cells[10:70, place : place + thickness] = 100
        for turned in (cells, cells.T):
            index = index_grid(Grid(np.ascontiguousarray(turned), 0.05, Pose2(0, 0, 0)))
            picture = draw_map(index, Viewport(2.0, 2.0, 0.05 * cells_per_pixel, 48, 48), DARK)
            walls = (picture == DARK.wall).all(axis=2)
            walls = walls if turned is cells else walls.T
            assert walls.sum(axis=1)[walls.any(axis=1)].max() == 1
            assert walls.any(axis=1).sum() >= 60 / cells_per_pixel - 2
            assert len(np.unique(picture.reshape(-1, 3), axis=0)) <= 3  # walls, floor, unknown: nothing between


@given(st.lists(st.lists(st.sampled_from([0.0, 0.0, 0.1, 0.3, 0.5, 0.7, 1.0]), min_size=7, max_size=7), min_size=7))
def test_thinner_walls_are_neither_cut_nor_lost(shares: list[list[float]]) -> None:
    share, everywhere = np.array(shares), np.ones((3, 3))
    before, count = label(share > 0.0, structure=everywhere)
    after, pieces = label(thin_walls(share), structure=everywhere)
    assert pieces == count
    assert {*before[after > 0].tolist()} == {*range(1, count + 1)}


def test_turned_map_is_drawn_turned() -> None:
    turned = grid([[100, 0, 0]], origin=Pose2(0, 0, math.pi / 2))  # its x axis is the map's y axis
    picture = draw_map(index_grid(turned), Viewport(-0.5, 1.5, 1.0, 1, 3), DARK)
    assert picture[2, 0].tolist() == list(DARK.wall)
    assert picture[0, 0].tolist() == list(DARK.free)


def test_no_map_is_all_unknown() -> None:
    assert (draw_map(None, Viewport(0, 0, 1, 4, 2), DARK) == DARK.unknown).all()


def test_scan_and_path_are_drawn_and_clipped() -> None:
    view = Viewport(0.0, 0.0, 1.0, 10, 10)
    base = draw_map(None, view, DARK)
    snapshot = RobotSnapshot(scan=np.array([[2.5, 2.5], [99.0, 0.0]]), path=np.array([[-20.0, -2.5], [20.0, -2.5]]))
    picture = draw_overlay(base, snapshot, view, DARK)
    assert picture[2, 7].tolist() == list(DARK.scan)
    assert (picture[7] == DARK.path).all()
    assert (base == DARK.unknown).all()


def test_robot_close_by_is_drawn_to_scale() -> None:
    view = Viewport(0.0, 0.0, 0.02, 60, 60)
    snapshot = RobotSnapshot(pose=Pose2(0.0, 0.0, 0.0))
    picture = draw_overlay(draw_map(None, view, DARK), snapshot, view, DARK)
    rows, columns = np.nonzero((picture == DARK.robot).all(axis=2))
    assert columns.max() - columns.min() == pytest.approx(0.45 / 0.02, abs=2)
    assert rows.max() - rows.min() == pytest.approx(0.45 / 0.02, abs=2)
    assert picture[30, 36].tolist() == list(DARK.ink)  # the stripe is on the side of x
    assert picture[30, 24].tolist() == list(DARK.robot)


@pytest.mark.parametrize("palette", [DARK, DARK_16], ids=["256 colours", "16 colours"])
@given(
    row=st.integers(0, 59),
    column=st.integers(0, 59),
    cells_per_pixel=st.floats(0.3, 25.0),
    yaw=st.floats(-math.pi, math.pi),
    shift=st.floats(-0.5, 0.5),
)
def test_single_cell_of_wall_is_seen_at_any_scale(
    palette: MapPalette, row: int, column: int, cells_per_pixel: float, yaw: float, shift: float
) -> None:
    cells = np.zeros((60, 60), np.int8)
    cells[row, column] = 100
    index = index_grid(Grid(cells, 0.05, Pose2(0.0, 0.0, yaw)))
    size = int(200 / cells_per_pixel) + 4
    c, s = math.cos(yaw), math.sin(yaw)
    x, y = 1.5 * c - 1.5 * s + shift, 1.5 * s + 1.5 * c + shift
    picture = draw_map(index, Viewport(x, y, 0.05 * cells_per_pixel, size, size), palette)
    half_of_a_wall = (min(palette.wall) + max(palette.free)) // 2
    assert ((picture != palette.unknown).any(axis=2) & (picture.min(axis=2) >= half_of_a_wall)).any()


def test_walls_are_not_made_up() -> None:
    index = index_grid(Grid(np.zeros((60, 60), np.int8), 0.05, Pose2(0.0, 0.0, 0.3)))
    picture = draw_map(index, Viewport(1.0, 1.0, 0.3, 20, 20), DARK)
    assert {tuple(pixel) for row in picture.tolist() for pixel in row} == {DARK.free, DARK.unknown}
