"""The part of a map on a screen. A pixel is half a terminal cell: cells are about twice as high as wide."""

from __future__ import annotations

from dataclasses import dataclass, replace

MARGIN = 1.04
"""Factor between the picture and the map when all of the map is shown."""

_FINEST, _COARSEST = 0.005, 5.0  # m per pixel


@dataclass(frozen=True, slots=True)
class Viewport:
    """The map point in the middle, m per pixel, and the size in pixels. Rows go down, y goes up."""

    x: float
    y: float
    scale: float
    width: int
    height: int

    def to_map(self, column: float, row: float) -> tuple[float, float]:
        """Return the map point at a position on the screen, in pixels from the top left corner."""
        return self.x + (column - self.width / 2) * self.scale, self.y - (row - self.height / 2) * self.scale

    def to_pixel(self, x: float, y: float) -> tuple[float, float]:
        """Return column and row in pixels of a map point, which may be off the screen."""
        return (x - self.x) / self.scale + self.width / 2, (self.y - y) / self.scale + self.height / 2


def fit_viewport(bounds: tuple[float, float, float, float], width: int, height: int) -> Viewport:
    """Return the viewport that just contains a box (left, bottom, right, top in m)."""
    left, bottom, right, top = bounds
    scale = max((right - left) / max(width, 1), (top - bottom) / max(height, 1)) * MARGIN
    return Viewport((left + right) / 2, (bottom + top) / 2, _clamp(scale), width, height)


def zoom_viewport(view: Viewport, factor: float, column: float | None = None, row: float | None = None) -> Viewport:
    """Return the view magnified by `factor` about a pixel (default: the middle), which stays in its place."""
    column = view.width / 2 if column is None else column
    row = view.height / 2 if row is None else row
    x, y = view.to_map(column, row)
    scale = _clamp(view.scale / factor)
    return replace(view, scale=scale, x=x - (column - view.width / 2) * scale, y=y + (row - view.height / 2) * scale)


def pan_viewport(view: Viewport, columns: float, rows: float) -> Viewport:
    """Move the view right and down by a number of pixels."""
    return replace(view, x=view.x + columns * view.scale, y=view.y - rows * view.scale)


def resize_viewport(view: Viewport, width: int, height: int) -> Viewport:
    """Return the same middle and scale on a screen of another size."""
    return replace(view, width=width, height=height)


def _clamp(scale: float) -> float:
    return min(max(scale, _FINEST), _COARSEST)
