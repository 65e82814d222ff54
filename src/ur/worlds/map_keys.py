"""The keys of a map's YAML file, in the format of map_server, without its image.

Format: https://wiki.ros.org/map_server.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ur.source.section import Section

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
