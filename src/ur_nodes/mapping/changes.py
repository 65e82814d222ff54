"""Requests to change the map that is served: read from text that may come from anywhere; walls are changed as asked."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from ur.maps.record import MOST_STROKES, read_edit
from ur.maps.store import MapStore
from ur.maps.walls import draw_walls, restore_walls
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

_LONGEST = 20_000  # characters


def read_change(text: str) -> dict[str, Any] | None:
    """The request that a text is, a JSON object with an `id`; None: it is none."""
    if len(text) > _LONGEST:
        return None
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        return None
    known = isinstance(value, dict) and isinstance(value.get("id"), str) and len(value["id"]) <= 100
    return value if known else None


def change_walls(
    store: MapStore, name: str, grid: Grid, request: Mapping[str, Any], use: Callable[[Grid], None]
) -> None:
    """Draw, erase or restore walls of the map `name` ('': it is not stored), which is served as `grid`.

    `use` is called with the new one before anybody else can change the map. Raises UserError, ValueError, TypeError or
    OSError: it is as before.
    """
    if not name:
        raise ValueError("the map in use is a file, expected a stored map: ur maps import")
    if request.get("map") != name:
        raise ValueError(f"the map in use is {name}, expected the one that was drawn on")
    if request.get("do") == "restore":
        change = restore_walls(store, name)
    elif request.get("do") == "draw":
        found = request.get("strokes")
        if not isinstance(found, list) or len(found) > MOST_STROKES:
            raise ValueError(f"strokes: expected at most {MOST_STROKES}")
        change = draw_walls(store, name, [read_edit(each) for each in found], grid)
    else:
        raise ValueError("do: expected draw or restore")
    with change as image:
        use(Grid(image.values, image.resolution, Pose2(*image.origin)))
