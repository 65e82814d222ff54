from pathlib import Path

import numpy as np
import pytest

from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.mapping.map_saver import save_map


def test_saved_grid_is_read_back_as_it_was(tmp_path: Path) -> None:
    grid = Grid(np.array(((0, 100, -1), (100, -1, 0)), dtype=np.int8), 0.05, Pose2(-1.25, 3.0, 0.5))
    read = load_map(save_map(tmp_path / "flat", grid))
    assert np.array_equal(read.values, grid.values)
    assert read.origin == pytest.approx(grid.origin)
