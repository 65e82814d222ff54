"""Masks hold what the zones say, in the format that costmap filters read."""

from pathlib import Path

import numpy as np
import pytest

from ur.maps.edit import Lattice
from ur.maps.record import Zone
from ur.maps.zone_mask import area_of, draw_mask, write_masks
from ur.worlds.cells import look_up
from ur.worlds.map_file import read_map

PLAN = Lattice((100, 200), 0.05, (-1.0, -2.0, 0.0))
STAIRS = Zone("stairs", "keep-out", ((0.0, 0.0), (1.0, 0.0), (1.0, 0.5)))
HALL = Zone("hall", "speed", ((2.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0)), 40)
SLOWER = Zone("door", "speed", ((3.0, 0.0), (5.0, 0.0), (5.0, 1.0), (3.0, 1.0)), 10)


def test_mask_covers_its_zones_on_the_cells_of_the_map() -> None:
    mask = draw_mask([STAIRS, HALL], "keep-out", PLAN)
    assert mask is not None
    assert mask.values.shape == (10, 20)
    assert mask.origin == pytest.approx((0.0, 0.0))
    assert mask.values[0, -1] == 100
    assert mask.values[-1, 0] == 0


def test_lowest_speed_counts_where_zones_overlap() -> None:
    for zones in ([HALL, SLOWER], [SLOWER, HALL]):
        mask = draw_mask(zones, "speed", PLAN)
        assert mask is not None
        assert mask.values[5, 30] == 10
        assert mask.values[30, 30] == 40
        assert mask.values[30, 50] == 0


def test_zone_beyond_the_map_makes_no_larger_mask() -> None:
    far = Zone("far", "keep-out", ((-1e4, -1e4), (1e4, -1e4), (1e4, 1e4), (-1e4, 1e4)))
    mask = draw_mask([far], "keep-out", PLAN)
    assert mask is not None
    assert mask.values.shape == (100, 200)
    assert (mask.values == 100).all()
    away = Zone("away", "keep-out", ((50.0, 50.0), (51.0, 50.0), (51.0, 51.0)))
    assert draw_mask([away], "keep-out", PLAN) is None


def test_files_of_masks_are_those_of_map_server(tmp_path: Path) -> None:
    write_masks(tmp_path, [STAIRS, HALL], PLAN)
    stairs, hall = read_map(tmp_path / "keepout_mask.yaml"), read_map(tmp_path / "speed_mask.yaml")
    points = np.array(((0.9, 0.1), (0.1, 0.4), (3.0, 1.0)))
    assert look_up(stairs, stairs.values, points, 0).tolist() == [100, 0, 0]
    assert look_up(hall, hall.values, points, 0).tolist() == [0, 0, 40]
    write_masks(tmp_path, [HALL], PLAN)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["speed_mask.pgm", "speed_mask.yaml"]


def test_geometry_of_polygons() -> None:
    assert area_of(STAIRS.points) == pytest.approx(0.25)
