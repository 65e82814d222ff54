"""Masks of zones, as the costmap filters of Nav2 read them: grids over the zones, and files in map_server's format.

A keep-out mask is 100 in the zones. A speed mask has the percentage of the highest speed in them. 0 is no limit
(docs.nav2.org, "Keepout Filter" and "Speed Filter", types 0 and 1 with base 0 and multiplier 1).
"""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ur.maps.edit import Lattice, fill_polygon
from ur.maps.record import Zone, ZoneKind
from ur.source.replace import replace_file
from ur.worlds.cells import CellFrame

_FILES: dict[ZoneKind, str] = {"keep-out": "keepout_mask", "speed": "speed_mask"}
_FORBIDDEN = 100


@dataclass(frozen=True, slots=True, eq=False)
class Mask:
    """A mask: `values` int8 (height, width), row 0 at the bottom; `resolution` in m; `origin` x, y of its corner."""

    values: NDArray[np.int8]
    resolution: float
    origin: tuple[float, float]


def draw_mask(zones: Iterable[Zone], kind: ZoneKind, plan: CellFrame) -> Mask | None:
    """Draw the zones of a kind on cells of the map's resolution; None if none of them is on the map.

    The mask covers the zones within the map. Where speed zones overlap, the lowest percentage applies.
    """
    chosen = [zone for zone in zones if zone.kind == kind]
    if not chosen:
        return None
    corners = np.array([point for zone in chosen for point in zone.points])
    left, bottom, right, top = plan.bounds
    low = np.maximum(corners.min(axis=0), (left, bottom))
    high = np.minimum(corners.max(axis=0), (right, top))
    # On the lattice of the map's own cells where the map is not turned.
    anchor = np.array(plan.origin[:2])
    first = np.floor((low - anchor) / plan.resolution + 1e-6)
    columns, rows = (np.ceil((high - anchor) / plan.resolution - 1e-6) - first).astype(int)
    if columns <= 0 or rows <= 0:
        return None
    x, y = (anchor + first * plan.resolution).tolist()
    frame = Lattice((int(rows), int(columns)), plan.resolution, (x, y, 0.0))
    values = np.zeros(frame.shape, np.int8)
    for zone in sorted(chosen, key=lambda each: -each.percent):
        values[fill_polygon(frame, np.array(zone.points))] = zone.percent or _FORBIDDEN
    return Mask(values, plan.resolution, (x, y))


def write_masks(folder: Path, zones: Iterable[Zone], plan: CellFrame) -> None:
    """Write the masks of a map beside it, each an image and a YAML file; remove those without a zone.

    Raises OSError.
    """
    zones = tuple(zones)
    for kind, name in _FILES.items():
        mask = draw_mask(zones, kind, plan)
        file, image = folder / f"{name}.yaml", folder / f"{name}.pgm"
        if mask is None:
            file.unlink(missing_ok=True)
            image.unlink(missing_ok=True)
            continue
        height, width = mask.values.shape
        pixels = np.ascontiguousarray(mask.values[::-1]).astype(np.uint8)
        replace_file(image, f"P5\n{width} {height}\n255\n".encode() + pixels.tobytes(), parents=True)
        replace_file(file, _describe(image.name, mask))


def area_of(points: Iterable[tuple[float, float]]) -> float:
    """Return the area of a polygon in m^2."""
    corners = list(points)
    return abs(sum(x * v - u * y for (x, y), (u, v) in zip(corners, [*corners[1:], corners[0]], strict=True))) / 2.0


def _describe(image: str, mask: Mask) -> str:
    x, y = mask.origin
    return (
        f"image: {image}\nresolution: {mask.resolution:g}\norigin: [{x:.6g}, {y:.6g}, 0]\nnegate: 0\n"
        "occupied_thresh: 1.0\nfree_thresh: 0.0\nmode: raw\n"
    )
