"""Pictures of explorations: the map in grey, the way driven in red."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

_SCALE = 3  # pixels of a cell


def draw_exploration(grid: Grid, track: Sequence[Pose2], file: Path) -> None:
    """Write a PNG."""
    shades = np.full((*grid.shape, 3), 160, np.uint8)
    shades[grid.values == 0] = 255
    shades[grid.values >= 65] = 0
    image = Image.fromarray(shades[::-1]).resize((grid.width * _SCALE, grid.height * _SCALE), Image.Resampling.NEAREST)
    cells = grid.fractions_of_points(np.array([pose[:2] for pose in track]))
    line = [(_SCALE * column, _SCALE * (grid.height - row)) for row, column in cells.tolist()]
    ImageDraw.Draw(image).line(line, fill=(255, 0, 0), width=2)
    image.save(file)
