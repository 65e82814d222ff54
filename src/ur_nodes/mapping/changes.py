"""Requests to change the served map, as untrusted text, and their results."""

from collections.abc import Callable, Mapping
from typing import TypeVar

from ur.maps.record import MOST_STROKES, read_edit
from ur.maps.store import MapStore
from ur.maps.walls import draw_walls, restore_walls
from ur.source.diagnostic import UserError
from ur.source.foreign.json_values import BadJsonError, read_json
from ur.source.printable import printable
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality

Outcome = TypeVar("Outcome")

_LONGEST = 20_000  # characters


def read_change(text: str) -> dict[str, object] | None:
    """Parse a request, a JSON object with an `id`; None if it is malformed."""
    try:
        value = read_json(text, dict[str, object], _LONGEST)
    except BadJsonError:
        return None
    return value if isinstance(value.get("id"), str) and len(str(value["id"])) <= 100 else None


def subscribe_changes(node: Node, topic: str, callback: Callable[[Mapping[str, object]], None]) -> None:
    """Pass the requests of a topic to `callback`; malformed ones are reported."""

    def read(text: str) -> None:
        request = read_change(text)
        if request is None:
            node.log.error(f"{node.resolve(topic)}: not a request, expected JSON with an id", every=10.0)
        else:
            callback(request)

    node.subscribe(topic, str, read, Quality.EVERY)


def attempt(change: Callable[[], Outcome], what: str) -> tuple[Outcome | None, str]:
    """Change a file, described by `what`; return the result, and the error, '' for none."""
    try:
        return change(), ""
    except UserError as found:
        problem = found.diagnostics[0].message
    except (ValueError, TypeError) as found:
        problem = str(found)
    except OSError as found:
        problem = f"{what} cannot be written: {(found.strerror or str(found)).lower()}"
    return None, printable(problem)[:300]


def change_walls(store: MapStore, name: str, grid: Grid, request: Mapping[str, object]) -> Grid:
    """Draw, erase or restore walls of the map `name` ('': it is not stored), which is served as `grid`.

    Returns the new one. Raises UserError, ValueError, TypeError or OSError: it is as before.
    """
    if not name:
        raise ValueError("the map in use is a file, expected a stored map: ur maps import")
    if request.get("map") != name:
        raise ValueError(f"the map in use is {name}, expected the one that was drawn on")
    if request.get("do") == "restore":
        image = restore_walls(store, name)
    elif request.get("do") == "draw":
        found = request.get("strokes")
        if not isinstance(found, list) or len(found) > MOST_STROKES:
            raise ValueError(f"strokes: expected at most {MOST_STROKES}")
        image = draw_walls(store, name, [read_edit(each) for each in found], grid)
    else:
        raise ValueError("do: expected draw or restore")
    return Grid(image.values, image.resolution, Pose2(*image.origin))
