"""Floor plans from a picture or a size, as the image and the YAML file of a world."""

import io
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ur.source.diagnostic import UserError, user_error
from ur.source.foreign.pictures import MAP_FORMATS, open_picture

FREE, OCCUPIED, UNKNOWN = 254, 0, 205
"""Levels of grey as map_server writes them."""

CELL = 0.05  # m
LARGEST = 4000  # cells along an edge
_DARK = 128  # below is a wall
_WALL = 2  # cells
_ROOM = 1.5  # m: more distance from walls makes no better start
_CLEAR = 0.3  # m from the start to the nearest wall: a robot, and some to spare

Levels = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Drawing:
    """A floor plan: grey `levels`, row 0 at the top, the edge of a cell in m, and the cell (column, row) of the start.

    The lower left corner of that cell is (0, 0). `added_wall`: the floor reached the edge of the picture, and a wall
    was added there.
    """

    levels: Levels
    cell: float
    start: tuple[int, int]
    added_wall: bool = False

    @property
    def origin(self) -> tuple[float, float]:
        """Return the lower left corner in m, relative to the start."""
        column, row = self.start
        rows = self.levels.shape[0]
        return -round(column * self.cell, 6), -round((rows - row) * self.cell, 6)

    @property
    def size(self) -> tuple[float, float]:
        """Return width and height in m."""
        rows, columns = self.levels.shape
        return round(columns * self.cell, 6), round(rows * self.cell, 6)


def draw_room(width: float, height: float, cell: float = CELL) -> Drawing:
    """Draw an empty room with walls around a floor of `width` x `height` m; robots start in the middle."""
    columns, rows = (max(1, round(length / cell)) for length in (width, height))
    _check_size(columns, rows, cell)
    levels = np.full((rows + 2 * _WALL, columns + 2 * _WALL), OCCUPIED, np.uint8)
    levels[_WALL:-_WALL, _WALL:-_WALL] = FREE
    return Drawing(levels, cell, (_WALL + columns // 2, _WALL + rows // 2))


def draw_picture(path: Path, width: float, cell: float = CELL) -> Drawing:
    """Make a floor plan of a picture that is `width` m wide: dark is wall, light is floor, grey 205 is unknown.

    Raises UserError for an invalid picture, one without enough floor for a robot, or too many cells.
    """
    pixels = _read_grey(path)
    height = width * pixels.shape[0] / pixels.shape[1]
    columns, rows = max(1, round(width / cell)), max(1, round(height / cell))
    _check_size(columns, rows, cell)
    kinds = np.where(pixels < _DARK, OCCUPIED, FREE).astype(np.uint8)
    kinds[pixels == UNKNOWN] = UNKNOWN
    levels = _resample(kinds, columns, rows)
    levels, added = _close(_forget_outside(levels, cell))
    start = _find_start(levels, cell, path)
    return Drawing(levels, cell, start, added)


def write_png(levels: Levels) -> bytes:
    """Encode levels of grey as PNG."""
    from PIL import Image

    out = io.BytesIO()
    Image.fromarray(levels).save(out, "PNG", optimize=True)
    return out.getvalue()


def write_world(drawing: Drawing, image: str, title: str) -> str:
    """Return the world file, which is also a map in map_server's format, with comments on every setting."""
    x, y = drawing.origin
    width, height = drawing.size
    return f"""\
# {title}
# A world of the simulator and a map: world:=PATH and map_file:=PATH both take this file.

# The floor plan: {width:g} x {height:g} m. Draw in the picture with any program: black is wall, white is floor.
image: {image} # relative to this file
resolution: {drawing.cell:g} # m per pixel
origin: [{x:g}, {y:g}, 0.0] # x, y (m) of the lower left corner, and its yaw: (0, 0) is where robots start
negate: 0
occupied_thresh: 0.65 # darker pixels are walls
free_thresh: 0.196 # lighter pixels are floor; what lies between is unknown

# The simulator reads these as well; a map server ignores them.
wall_height: 1.0 # m
floor_friction: 0.9 # dry rubber on a hard floor; 0.1 is wet ice
# start: [0.0, 0.0, 0.0] # x, y (m), yaw (rad): where the first robot starts
# boxes: # stand fast, and lidars see them; they are not on the map
#   - {{name: table, pose: [1.0, 1.0, 0.72, 0.0], size: [1.2, 0.8, 0.04]}} # x, y, z of the centre, yaw; edges in m
# obstacles: # can be pushed; they stand on the floor
#   - {{name: chair, pose: [1.0, -1.0, 0.0], size: [0.4, 0.4, 0.8], mass: 4.0}} # x, y, yaw; edges in m; kg
"""


def _read_grey(path: Path) -> Levels:
    from PIL import Image, UnidentifiedImageError

    try:
        with open_picture(path, MAP_FORMATS) as opened:
            image = opened.convert("RGBA") if "transparency" in opened.info or "A" in opened.mode else opened
            if image.mode == "RGBA":  # what is transparent is paper
                paper = Image.new("RGBA", image.size, (255, 255, 255, 255))
                image = Image.alpha_composite(paper, image)
            wide = image.mode.startswith("I") or image.mode == "F"
            pixels = np.asarray(image if wide else image.convert("L"))
    except FileNotFoundError:
        raise _bad(path, "does not exist, expected the picture of a floor plan") from None
    except UnidentifiedImageError:
        raise _bad(path, "is not a picture, expected PNG, JPEG, PGM or another common format") from None
    except (OSError, ValueError, SyntaxError, EOFError, LookupError, TypeError, OverflowError) as problem:
        reason = problem.strerror.lower() if isinstance(problem, OSError) and problem.strerror else problem
        raise _bad(path, f"cannot be read: {reason}; expected an undamaged picture") from None
    if wide:
        pixels = pixels.astype(np.float64) / 257.0
    return np.asarray(np.clip(pixels, 0, 255), dtype=np.uint8)


def _resample(levels: Levels, columns: int, rows: int) -> Levels:
    """Change the number of cells; a wall of one pixel stays a wall."""
    for axis, wanted in ((0, rows), (1, columns)):
        have = levels.shape[axis]
        firsts = np.arange(wanted) * have // wanted
        # Levels rise from wall over unknown to floor: the least one in a cell's pixels counts.
        levels = np.minimum.reduceat(levels, firsts, axis) if wanted < have else np.take(levels, firsts, axis)
    return levels


def _forget_outside(levels: Levels, cell: float) -> Levels:
    """Mark the paper around closed walls as unknown; without closed walls around enough floor it stays floor."""
    from scipy.ndimage import label

    regions, _ = label(levels == FREE)
    edges = np.concatenate([regions[0], regions[-1], regions[:, 0], regions[:, -1]])
    outside = np.isin(regions, edges[edges > 0])
    inside = np.where(outside, OCCUPIED, levels).astype(np.uint8)
    if _measure_room(inside, cell).max() < _CLEAR:
        return levels
    return np.where(outside, UNKNOWN, levels).astype(np.uint8)


def _measure_room(levels: Levels, cell: float) -> npt.NDArray[np.float64]:
    """Return the distance of each cell from the nearest cell that is not floor, m, up to the relevant limit."""
    from scipy.ndimage import distance_transform_edt

    room: npt.NDArray[np.float64] = distance_transform_edt(np.pad(levels == FREE, 1))[1:-1, 1:-1]
    return np.minimum(room * cell, _ROOM)


def _close(levels: Levels) -> tuple[Levels, bool]:
    edge = np.concatenate([levels[0], levels[-1], levels[:, 0], levels[:, -1]])
    if not (edge == FREE).any():
        return levels, False
    return np.pad(levels, _WALL, constant_values=OCCUPIED), True


def _find_start(levels: Levels, cell: float, path: Path) -> tuple[int, int]:
    """Return the cell nearest to the middle of the picture with enough free space around it."""
    room = _measure_room(levels, cell)
    best = float(room.max())
    if best < _CLEAR:
        message = f"has no floor that is {2 * _CLEAR:g} m wide, expected light floor between dark walls"
        raise _bad(path, message, "is the width of the picture in m right, and is the floor white?")
    rows, columns = np.nonzero(room >= min(best, _ROOM) * 0.999)
    middle = np.hypot(rows - levels.shape[0] / 2.0, columns - levels.shape[1] / 2.0)
    nearest = int(np.argmin(middle))
    return int(columns[nearest]), int(rows[nearest])


def _check_size(columns: int, rows: int, cell: float) -> None:
    if not (math.isfinite(cell) and max(columns, rows) <= LARGEST):
        message = (
            f"the floor plan would have {columns} x {rows} cells of {cell:g} m, "
            f"expected at most {LARGEST} ({LARGEST * cell:g} m) along an edge"
        )
        raise user_error(message, rule="bad-size", help="lengths are in m: are these right?")


def _bad(path: Path, message: str, help: str | None = None) -> UserError:
    return user_error(f"picture {str(path)!r} {message}", rule="bad-image", help=help)
