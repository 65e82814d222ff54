"""Map files: a floor plan image and the YAML file beside it, in the format of map_server.

Format: https://wiki.ros.org/map_server. If its text and the behaviour of map_server differ (transparency), this module
follows the behaviour; comments mark these cases.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from ur.source.foreign.pictures import MAP_FORMATS, open_picture
from ur.source.section import Section, read_section
from ur.worlds.cells import FREE, OCCUPIED, UNKNOWN, CellFrame, translate_cells

Mode = Literal["trinary", "scale", "raw"]
_FINEST, _COARSEST = 1e-6, 1e6  # m per pixel
_FARTHEST = 1e9  # m; northings of UTM reach 1e7
_MODES: tuple[Mode, ...] = ("trinary", "scale", "raw")


@dataclass(frozen=True, slots=True)
class MapFile:
    """The contents of a map's YAML file.

    Thresholds are probabilities; `resolution` is in m per pixel; `origin` is x, y, yaw (m, rad) of the outer corner of
    the lower left pixel in the map frame.
    """

    image: Path
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: Mode


def parse_map_file(section: Section, folder: Path) -> MapFile:
    """Parse the keys of a map file, and ignore others. `folder` is that of a relative image path. Raises UserError."""
    section = section.with_numbers("resolution", "origin", "negate", "occupied_thresh", "free_thresh")
    image = section.text("image")
    if not image:
        section.fail("image", "image: '' in a map file, expected the path of an image")
    resolution = section.number("resolution")
    if resolution <= 0.0:
        section.fail("resolution", f"resolution: {resolution:g} in a map file, expected more than 0 m per pixel")
    if not _FINEST <= resolution <= _COARSEST:
        limits = f"{_FINEST:g} to {_COARSEST:g} m per pixel"
        section.fail("resolution", f"resolution: {resolution:g} in a map file, expected {limits}")
    origin = section.numbers("origin", 3)
    if max(map(abs, origin)) > _FARTHEST:
        section.fail("origin", f"origin: {list(origin)} in a map file, expected at most {_FARTHEST:g} m")
    negate = section.boolean("negate")
    occupied = section.number("occupied_thresh", minimum=0.0, maximum=1.0)
    free = section.number("free_thresh", minimum=0.0, maximum=1.0)
    if free > occupied:
        section.fail(
            "free_thresh", f"free_thresh: {free:g} in a map file, expected at most occupied_thresh, {occupied:g}"
        )
    wanted = section.text("mode", "trinary", choices=_MODES)
    mode = next(mode for mode in _MODES if mode == wanted)
    return MapFile(folder / image, resolution, (origin[0], origin[1], origin[2]), negate, occupied, free, mode)


if TYPE_CHECKING:
    from PIL import Image

_AT_ONCE = 4_000_000  # pixels: their sums take eight times as much memory


@dataclass(frozen=True, slots=True, eq=False)
class MapImage(CellFrame):
    """A map file with its cells: int8 (height, width), row 0 at the bottom, -1 unknown, 0 free to 100 occupied."""

    file: MapFile
    values: NDArray[np.int8]

    @property
    def resolution(self) -> float:  # type: ignore[override]  # read-only, as in every subclass
        """Return the side of a cell in m."""
        return self.file.resolution

    @property
    def origin(self) -> tuple[float, float, float]:  # type: ignore[override]
        """Return the pose of the corner of cell (0, 0) in the map frame: m, m, rad."""
        return self.file.origin

    @property
    def shape(self) -> tuple[int, int]:
        """Return the numbers of rows and columns."""
        height, width = self.values.shape
        return height, width

    @property
    def walls(self) -> NDArray[np.bool_]:
        """Return the occupied cells. In mode raw, those are values from above `occupied_thresh` (times 100) to 100."""
        if self.file.mode == "raw":
            walls: NDArray[np.bool_] = (self.values > 100.0 * self.file.occupied_thresh) & (self.values <= OCCUPIED)
            return walls
        return np.asarray(self.values == OCCUPIED)

    def wall_at(self, x: float, y: float) -> bool | None:
        """Return whether a point of the map frame (m) lies in a wall; None outside of the map."""
        cell = self.cells_of_points(np.array((x, y)))
        return bool(self.walls[tuple(cell)]) if self.contains(cell) else None


def read_map(path: str | Path) -> MapImage:
    """Read a map's YAML file, or the one that a world file of the simulator names as its floor plan, and its image.

    Raises UserError, with file, line and column if known, for a missing file, invalid YAML, an invalid value, or a
    missing or damaged image.
    """
    section = read_section(path, "a map file")
    if section.has("floor_plan") and not section.has("image"):
        path = Path(path).parent / section.text("floor_plan")
        section = read_section(path, "a map file", piped=False)
    return read_map_section(section, Path(path).parent)


def read_map_section(section: Section, folder: Path, *, inside: Path | None = None) -> MapImage:
    """Read a map from a file that may have other keys; with `inside`, its image must be below that folder.

    Raises the same errors as `read_map`.
    """
    file = parse_map_file(section, folder)
    return MapImage(file, _read_cells(file, section, inside))


def occupancy_of_pixels(pixels: NDArray[np.uint8], file: MapFile) -> NDArray[np.int8]:
    """Return cell values (height, width), row 0 at the bottom, of pixels (height, width, channels), row 0 on top.

    1 channel is grey, 3 are colours, 4 are colours and alpha. Channels are averaged, alpha with them in mode trinary.
    With p the darkness of a pixel from 0 to 1 (its brightness with `negate`): trinary gives 100 above
    `occupied_thresh`, 0 below `free_thresh`, -1 between; scale gives 1 to 99 between, and -1 there where the pixel is
    wholly transparent (the documentation says "any transparency, anywhere"); raw gives the average itself, as a
    signed byte.
    """
    if pixels.shape[2] == 1:  # as every map of ours: each shade is worked out once
        shades = _occupancy_of_averages(np.arange(256.0)[None], None, file)[0]
        return translate_cells(pixels[::-1, :, 0], shades)
    has_alpha = pixels.shape[2] == 4
    colours = pixels[..., :3] if has_alpha and file.mode != "trinary" else pixels
    clear = pixels[..., 3] == 0 if has_alpha else None
    return np.ascontiguousarray(_occupancy_of_averages(colours.mean(axis=2, dtype=np.float64), clear, file)[::-1])


def _occupancy_of_averages(
    average: NDArray[np.float64], clear: NDArray[np.bool_] | None, file: MapFile
) -> NDArray[np.int8]:
    """Return cell values (height, width) of average brightnesses 0 to 255; `clear`: fully transparent pixels."""
    if file.negate:
        average = 255.0 - average
    if file.mode == "raw":
        return average.astype(np.uint8).view(np.int8)
    dark = (255.0 - average) / 255.0
    between = np.full(dark.shape, UNKNOWN, dtype=np.int8)
    if file.mode == "scale" and file.occupied_thresh > file.free_thresh:
        share = (dark - file.free_thresh) / (file.occupied_thresh - file.free_thresh)
        between = (1.0 + 98.0 * np.clip(share, 0.0, 1.0)).astype(np.int8)
        if clear is not None:
            between[clear] = UNKNOWN
    values = np.where(dark > file.occupied_thresh, OCCUPIED, np.where(dark < file.free_thresh, FREE, between))
    return values.astype(np.int8)


def _read_cells(file: MapFile, section: Section, inside: Path | None) -> NDArray[np.int8]:
    from PIL import UnidentifiedImageError

    path = file.image
    try:
        with open_picture(path, MAP_FORMATS, inside=inside) as image:
            image.load()
            cells = np.empty((image.height, image.width), np.int8)
            rows = max(1, _AT_ONCE // image.width)
            for top in range(0, image.height, rows):
                bottom = min(top + rows, image.height)
                band = image.crop((0, top, image.width, bottom))
                cells[image.height - bottom : image.height - top] = occupancy_of_pixels(_pixels(band), file)
            return cells
    except FileNotFoundError:
        section.fail("image", f"image: {path} is missing, expected an image", "the path is relative to the map file")
    except UnidentifiedImageError:
        section.fail("image", f"image: {path} is not an image, expected one, for example PNG or PGM")
    except (OSError, ValueError, SyntaxError, EOFError, LookupError, TypeError, OverflowError) as problem:
        reason = getattr(problem, "strerror", None) or problem
        section.fail("image", f"image: {path} cannot be read: {reason}; expected an undamaged image")


def _pixels(image: Image.Image) -> NDArray[np.uint8]:
    """Return the pixels (height, width, 1, 3 or 4); palettes are resolved, 16 bits become the upper 8."""
    if image.mode.startswith("I") or image.mode == "F":
        return (np.asarray(image).astype(np.int64) >> 8).clip(0, 255).astype(np.uint8)[..., None]
    if image.mode in ("1", "L"):
        return np.asarray(image.convert("L"))[..., None]
    transparent = image.mode in ("LA", "PA", "RGBA", "La", "RGBa") or "transparency" in image.info
    return np.asarray(image.convert("RGBA" if transparent else "RGB"))
