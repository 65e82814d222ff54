from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ur.maps.picture_file import write_picture
from ur.source.replace import replace_file
from ur.worlds.map_file import read_map

VALUES = np.array(((0, 100, -1), (100, -1, 0)), dtype=np.int8)


def test_written_map_is_read_back_as_it_was(tmp_path: Path) -> None:
    read = read_map(write_picture(tmp_path / "the flat's map", VALUES, 0.05, (-1.25, 3.0, 0.5)))
    assert np.array_equal(read.values, VALUES)
    assert read.resolution == 0.05
    assert read.origin == pytest.approx((-1.25, 3.0, 0.5))


def test_values_between_free_and_occupied_are_unknown(tmp_path: Path) -> None:
    values = np.array(((25, 26, 64, 65),), dtype=np.int8)
    assert read_map(write_picture(tmp_path / "map", values, 0.1, (0.0, 0.0, 0.0))).values.tolist() == [[0, -1, -1, 100]]


def test_folders_that_are_missing_are_made(tmp_path: Path) -> None:
    file = write_picture(tmp_path / "some" / "maps" / "flat", VALUES, 0.05, (0.0, 0.0, 0.0))
    assert read_map(file).width == 3


def test_map_that_is_written_again_keeps_an_image_of_its_own_at_every_moment(tmp_path: Path) -> None:
    name = tmp_path / "flat"
    write_picture(name, VALUES, 0.05, (0.0, 0.0, 0.0))
    larger = np.zeros((5, 5), np.int8)

    def fail_at_the_yaml(path: Path, content: str | bytes, **options: Any) -> None:
        if path.suffix == ".yaml":
            raise OSError("the power failed")
        replace_file(path, content, **options)

    with pytest.raises(OSError, match="the power failed"):
        write_picture(name, larger, 0.05, (-1.0, 0.0, 0.0), put=fail_at_the_yaml)
    assert np.array_equal(read_map(tmp_path / "flat.yaml").values, VALUES)
    for values in (larger, VALUES):
        assert np.array_equal(read_map(write_picture(name, values, 0.05, (0.0, 0.0, 0.0))).values, values)
        assert len(list(tmp_path.iterdir())) == 2
