from __future__ import annotations

import numpy as np
import pytest
import rospy

from ur.source.diagnostic import UserError
from ur_nodes.rosio.grid_update import apply_update, update_message


def test_update_changes_its_cells_of_a_grid_and_no_others() -> None:
    values = np.zeros((4, 5), np.int8)
    apply_update(values, update_message(np.array([[7, 8]], np.int8), 3, 2, "map", rospy.Time()))
    assert values[3].tolist() == [0, 0, 7, 8, 0]
    assert not values[:3].any()


@pytest.mark.parametrize(("row", "column", "extra"), [(4, 0, 0), (0, 4, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1)])
def test_update_that_does_not_fit_is_refused(row: int, column: int, extra: int) -> None:
    values = np.zeros((4, 5), np.int8)
    message = update_message(np.ones((1, 2), np.int8), row, column, "map", rospy.Time())
    message.height += extra
    with pytest.raises(UserError):
        apply_update(values, message)
    assert not values.any()
