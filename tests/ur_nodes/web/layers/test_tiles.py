import numpy as np

from ur.web.wire.frames import TILE
from ur_nodes.geometry.grid import UNKNOWN, Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.web.layers.tiles import Tiles, cut_tiles


def make_grid(height: int, width: int, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> Grid:
    return Grid(np.zeros((height, width), np.int8), 0.05, Pose2(x, y, yaw))


def test_first_grid_is_sent_whole_and_the_same_again_not_at_all() -> None:
    grid = make_grid(300, 600)
    tiles, changed = cut_tiles(Tiles(), grid)
    assert set(changed) == {(x, y) for x in range(3) for y in range(2)}
    assert tiles.frame is not None
    assert (tiles.frame.width, tiles.frame.height, tiles.frame.generation) == (600, 300, 1)
    assert tiles.tiles[2, 1].shape == (TILE, TILE)
    assert (tiles.tiles[2, 1] == UNKNOWN).sum() == TILE * TILE - (600 - 2 * TILE) * (300 - TILE)
    assert cut_tiles(tiles, grid)[1] == ()


def test_only_tiles_that_changed_are_sent() -> None:
    tiles, _ = cut_tiles(Tiles(), make_grid(600, 600))
    grid = make_grid(600, 600)
    grid.values[300, 10] = 100
    tiles, changed = cut_tiles(tiles, grid)
    assert changed == ((0, 1),)
    assert tiles.tiles[0, 1][300 - TILE, 10] == 100


def test_map_that_grows_to_the_left_stays_on_its_lattice() -> None:
    tiles, _ = cut_tiles(Tiles(), make_grid(100, 100))
    grid = make_grid(100, 140, x=-2.0)
    tiles, changed = cut_tiles(tiles, grid)
    assert tiles.frame is not None
    assert (tiles.frame.generation, tiles.frame.column, tiles.frame.origin) == (1, -40, (0.0, 0.0, 0.0))
    assert changed == ((-1, 0),)
    assert (tiles.tiles[-1, 0] != UNKNOWN).sum() == 40 * 100


def test_map_off_the_lattice_begins_anew() -> None:
    before, _ = cut_tiles(Tiles(), make_grid(100, 100))
    for grid in (make_grid(100, 100, x=0.026), make_grid(100, 100, yaw=0.1), make_grid(100, 100, x=1e6)):
        tiles, changed = cut_tiles(before, grid)
        assert tiles.frame is not None
        assert (tiles.frame.generation, tiles.frame.column) == (2, 0)
        assert changed == ((0, 0),)


def test_tiles_without_a_known_cell_are_left_out_and_cleared_when_they_become_so() -> None:
    grid = make_grid(TILE, 2 * TILE)
    grid.values[:, TILE:] = UNKNOWN
    assert cut_tiles(Tiles(), grid)[1] == ((0, 0),)
    tiles, _ = cut_tiles(Tiles(), make_grid(TILE, 2 * TILE))
    tiles, changed = cut_tiles(tiles, grid)
    assert changed == ((1, 0),)
    assert (tiles.tiles[1, 0] == UNKNOWN).all()


def test_rotated_map_that_grows_keeps_its_lattice() -> None:
    tiles, _ = cut_tiles(Tiles(), make_grid(100, 100, x=3.0, y=1.0, yaw=0.4))
    origin = Pose2(3.0, 1.0, 0.4).compose(Pose2(-1.0, -0.5, 0.0))
    tiles, _ = cut_tiles(tiles, Grid(np.zeros((110, 120), np.int8), 0.05, origin))
    assert tiles.frame is not None
    assert (tiles.frame.generation, tiles.frame.column, tiles.frame.row) == (1, -20, -10)
