import math

import numpy as np

from ur_nodes.slam.map_state import select_views

POSES = np.array([
    (0.0, 0.0, 0.0),
    (0.1, 0.0, 0.1),  # sees what 0 sees
    (0.1, 0.0, 2.0),  # another direction
    (1.0, 0.0, math.pi - 0.1),
    (1.0, 0.1, -math.pi + 0.1),  # the direction of 3, beyond the half turn
])  # fmt: skip


def test_keyframes_that_show_the_same_are_left_out() -> None:
    assert select_views(POSES, range(5)) == [0, 2, 3]


def test_earlier_candidates_win() -> None:
    assert select_views(POSES, [4, 3, 1, 0]) == [4, 1]


def test_selection_ends_with_the_greatest_number() -> None:
    assert select_views(POSES, range(5), most=2) == [0, 2]
    assert select_views(POSES, []) == []
