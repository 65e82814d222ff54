from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.mapping.save import save_map

VALUES = np.array(((0, 100, -1), (100, -1, 0)), dtype=np.int8)


def test_saved_map_is_read_back_as_it_was(tmp_path: Path) -> None:
    grid = Grid(VALUES, 0.05, Pose2(-1.25, 3.0, 0.5))
    read = load_map(save_map(tmp_path / "the flat's map", grid))
    assert np.array_equal(read.values, VALUES)
    assert read.resolution == 0.05
    assert read.origin == pytest.approx(grid.origin)


def test_values_between_free_and_occupied_are_unknown(tmp_path: Path) -> None:
    grid = Grid(np.array(((25, 26, 64, 65),), dtype=np.int8), 0.1, Pose2(0.0, 0.0, 0.0))
    assert load_map(save_map(tmp_path / "map", grid)).values.tolist() == [[0, -1, -1, 100]]


def test_folder_that_is_missing_is_an_error_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No such file"):
        save_map(tmp_path / "missing" / "map", Grid(VALUES, 0.05, Pose2(0.0, 0.0, 0.0)))
    assert not list(tmp_path.iterdir())
