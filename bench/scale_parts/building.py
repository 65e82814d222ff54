"""Floor plans of buildings of any size: corridors, rooms with doors, furniture, and unknown space round it all."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

RESOLUTION = 0.05
_PERIOD, _CORRIDOR, _WALL, _DOOR, _MARGIN = 240, 44, 3, 20, 20  # cells


def make_building(side: int, seed: int = 0) -> NDArray[np.int8]:
    """Draw a floor of `side` x `side` cells of 0.05 m: -1 unknown, 0 free, 100 occupied. The same for the same seed.

    Corridors of 2.2 m cross every 12 m. Each block between them has four rooms with doors of 1 m to the corridors and
    to each other, some of which are closed. Furniture and single legs stand in the rooms. One corridor in ten is
    closed by a wall, so that ways differ from straight lines.
    """
    rng = np.random.default_rng(seed)
    values = np.full((side, side), -1, np.int8)
    low, high = _MARGIN, side - _MARGIN
    values[low:high, low:high] = 0
    for edge in (slice(low, low + _WALL), slice(high - _WALL, high)):
        values[edge, low:high] = values[low:high, edge] = 100
    for top in range(low + _CORRIDOR, high, _PERIOD):
        for left in range(low + _CORRIDOR, high, _PERIOD):
            block = values[top : min(top + _PERIOD - _CORRIDOR, high), left : min(left + _PERIOD - _CORRIDOR, high)]
            if min(block.shape) > 90:
                _furnish(block, rng)
            elif min(block.shape) > 4 * _WALL:
                _draw_box(block)
            if rng.random() < 0.1:
                values[top + 60 : top + 60 + _WALL, max(low, left - _CORRIDOR) : left] = 100
            if rng.random() < 0.1:
                values[max(low, top - _CORRIDOR) : top, left + 60 : left + 60 + _WALL] = 100
    values[high:] = values[:, high:] = -1
    return values


def write_building(folder: Path, side: int, seed: int = 0) -> Path:
    """Write a floor as `building.pgm` and `building.yaml`, with its middle at (0, 0); returns the latter."""
    values = make_building(side, seed)
    shades = np.select([values == 0, values == 100], [254, 0], 205).astype(np.uint8)
    (folder / "building.pgm").write_bytes(f"P5\n{side} {side}\n255\n".encode() + shades[::-1].tobytes())
    corner = -side * RESOLUTION / 2.0
    file = folder / "building.yaml"
    file.write_text(
        f"image: building.pgm\nresolution: {RESOLUTION}\norigin: [{corner}, {corner}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        encoding="utf-8",
    )
    return file


def _draw_box(block: NDArray[np.int8]) -> None:
    block[:_WALL] = block[-_WALL:] = 100
    block[:, :_WALL] = block[:, -_WALL:] = 100


def _furnish(block: NDArray[np.int8], rng: np.random.Generator) -> None:
    """Draw the walls of four rooms, their doors and furniture."""
    height, width = block.shape
    _draw_box(block)
    middle, centre = height // 2 + int(rng.integers(-10, 11)), width // 2 + int(rng.integers(-10, 11))
    block[middle : middle + _WALL] = 100
    block[:, centre : centre + _WALL] = 100
    for rows in (slice(0, middle), slice(middle + _WALL, height)):
        for columns in (slice(0, centre), slice(centre + _WALL, width)):
            _place_furniture(block[rows, columns], rng)
    for row, column in ((0, 0), (0, centre + 5), (height - _WALL, 0), (height - _WALL, centre + 5)):
        if rng.random() < 0.9:  # from a room to the corridor
            start = column + int(rng.integers(14, 40))
            block[max(0, row - 12) : row + _WALL + 12, start : start + _DOOR] = 0
    for column in (0, centre + 5):
        if rng.random() < 0.5:  # from a room to the next
            start = column + int(rng.integers(14, 40))
            block[middle - 12 : middle + _WALL + 12, start : start + _DOOR] = 0


def _place_furniture(room: NDArray[np.int8], rng: np.random.Generator) -> None:
    height, width = room.shape
    for _ in range(int(rng.integers(2, 6))):
        rows, columns = rng.integers(6, 26, 2).tolist()
        if rows + 34 < height and columns + 34 < width:
            row, column = int(rng.integers(16, height - rows - 16)), int(rng.integers(16, width - columns - 16))
            room[row : row + rows, column : column + columns] = 100
    for row, column in rng.integers(10, max(11, min(height, width) - 10), (4, 2)).tolist():
        room[row : row + 1, column : column + 1] = 100
