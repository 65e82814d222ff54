import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from ur_nodes.simulator.mujoco_model import Rectangle, merge_cells


@given(arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.booleans()))
def test_rectangles_cover_each_occupied_cell_once_and_no_other(occupied: np.ndarray) -> None:
    covered = np.zeros(occupied.shape, int)
    for column, row, width, height in merge_cells(occupied):
        covered[row : row + height, column : column + width] += 1
    assert (covered == occupied).all()


def test_rectangles_of_a_frame_are_its_four_sides() -> None:
    frame = np.ones((20, 30), bool)
    frame[2:-2, 2:-2] = False
    assert len(merge_cells(frame)) == 4


def test_rectangles_of_a_full_grid_are_one() -> None:
    assert merge_cells(np.ones((3, 5), bool)) == (Rectangle(0, 0, 5, 3),)
