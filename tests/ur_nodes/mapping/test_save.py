from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ur.source.replace import replace_file
from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.mapping import save
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


def test_folders_that_are_missing_are_made(tmp_path: Path) -> None:
    file = save_map(tmp_path / "some" / "maps" / "flat", Grid(VALUES, 0.05, Pose2(0.0, 0.0, 0.0)))
    assert load_map(file).width == 3


def test_map_that_is_saved_again_keeps_an_image_of_its_own_at_every_moment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = tmp_path / "flat"
    save_map(name, Grid(VALUES, 0.05, Pose2(0.0, 0.0, 0.0)))
    larger = Grid(np.zeros((5, 5), np.int8), 0.05, Pose2(-1.0, 0.0, 0.0))

    def fail_at_the_yaml(path: Path, content: str | bytes, **options: bool) -> None:
        if path.suffix == ".yaml":
            raise OSError("the power failed")
        replace_file(path, content, **options)

    monkeypatch.setattr(save, "replace_file", fail_at_the_yaml)
    with pytest.raises(OSError, match="the power failed"):
        save_map(name, larger)
    assert np.array_equal(load_map(tmp_path / "flat.yaml").values, VALUES)
    monkeypatch.undo()
    for grid in (larger, Grid(VALUES, 0.05, Pose2(0.0, 0.0, 0.0))):
        assert np.array_equal(load_map(save_map(name, grid)).values, grid.values)
        assert len(list(tmp_path.iterdir())) == 2
