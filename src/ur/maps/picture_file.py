"""Pictures of occupancy grids in the format of map_server: an image and a YAML file beside it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ur.source.foreign.files import read_text
from ur.source.replace import replace_file
from ur.worlds.cells import OCCUPIED

Origin = tuple[float, float, float]

_DARK, _GREY, _LIGHT = 0, 205, 254  # upstream's: occupied, unknown, free
_OCCUPIED_FROM, _FREE_BELOW = 65, 25  # per cent, upstream's
_THRESHOLDS = (0.65, 0.196)  # of the file; the unknown grey lies between them


def write_picture(
    name: Path,
    values: NDArray[np.int8],
    resolution: float,
    origin: Origin,
    occupied: int = _OCCUPIED_FROM,
    free: int = _FREE_BELOW,
    put: Callable[..., None] = replace_file,
) -> Path:
    """Write `name`.pgm and `name`.yaml; returns the latter. Raises OSError. `put` replaces a file.

    `values` (height, width) are -1 unknown, 0 to 100 occupied, row 0 at the bottom; `resolution` is m per cell,
    `origin` (m, m, rad) the pose of the lower left corner. Cells from `occupied` on are walls, those up to `free` are
    floor, others are unknown. Missing folders are created. At every moment the YAML file is complete and names the
    matching image: if it already names `name`.pgm, the new image is `name`_2.pgm, and the old one is removed at the
    end.
    """
    file = name.with_name(f"{name.name}.yaml")
    images = [name.with_name(f"{name.name}{suffix}.pgm") for suffix in ("", "_2")]
    image, other = images[::-1] if _names(file, images[0].name) else images
    height, width = values.shape
    header = f"P5\n# {resolution:g} m per pixel\n{width} {height}\n255\n"
    put(image, header.encode() + shades(values, occupied, free).tobytes(), parents=True)
    put(file, describe_picture(image.name, resolution, origin))
    other.unlink(missing_ok=True)
    return file


def shades(values: NDArray[np.int8], occupied: int = _OCCUPIED_FROM, free: int = _FREE_BELOW) -> NDArray[np.uint8]:
    """Return the grey pixels (height, width) of cells, row 0 at the top."""
    pixels = np.full(values.shape, _GREY, np.uint8)
    pixels[(values >= 0) & (values <= free)] = _LIGHT
    pixels[(values >= occupied) & (values <= OCCUPIED)] = _DARK
    return np.ascontiguousarray(pixels[::-1])


def describe_picture(image: str, resolution: float, origin: Origin) -> str:
    """Return the text of a map's YAML file; `image` is relative to it."""
    pose = ", ".join(f"{value:.6g}" for value in origin)
    return (
        f"{_image_line(image)}\nresolution: {resolution:g}\norigin: [{pose}]\nnegate: 0\n"
        f"occupied_thresh: {_THRESHOLDS[0]}\nfree_thresh: {_THRESHOLDS[1]}\n"
    )


def _image_line(image: str) -> str:
    return "image: '" + image.replace("'", "''") + "'"


def _names(file: Path, image: str) -> bool:
    """Return whether a map's YAML file, of this project or of upstream, names an image."""
    try:
        lines = read_text(file).splitlines()
    except FileNotFoundError:
        return False
    return _image_line(image) in lines or f"image: {image}" in lines
