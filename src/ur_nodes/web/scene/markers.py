"""Markers as bounded JSON."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ur.source.printable import printable
from ur_nodes.ports.values import MarkerChange

_MOST = 300  # markers of one topic
_MOST_POINTS = 3000  # of one marker
_MOST_POINTS_OF_ALL = 12_000
_FARTHEST = 1e5  # m


class ShownMarkers:
    """The markers of one topic by namespace and id. Times are seconds of any steady clock."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, int], tuple[float, dict[str, Any]]] = {}
        self.changed = False

    def apply(self, change: MarkerChange, now: float) -> None:
        """Apply a change unless its marker is malformed."""
        key = change.marker.namespace[:200], change.marker.number
        if change.action == "clear":
            self._known.clear()
        elif change.action == "delete":
            self._known.pop(key, None)
        else:
            found = describe_marker(change)
            if found is None or (key not in self._known and len(self._known) >= _MOST):
                return
            self._known[key] = (now + change.lifetime if change.lifetime > 0 else math.inf), found
        self.changed = True

    def describe(self, now: float) -> list[dict[str, Any]]:
        """Return the markers that are shown at `now`, at most as many as pages get."""
        alive = {key: each for key, each in self._known.items() if each[0] > now}
        self._known, self.changed = alive, False
        shown, points = [], 0
        for _, each in alive.values():
            points += len(each.get("points", ())) // 3
            if points > _MOST_POINTS_OF_ALL:
                break
            shown.append(each)
        return shown

    def expires(self, now: float) -> bool:
        """Return whether a marker has expired since it was described."""
        return any(until <= now for until, _ in self._known.values())


def describe_marker(change: MarkerChange) -> dict[str, Any] | None:
    """Describe a marker as JSON: frame, kind, pose, scale, colour, points, text; None if it cannot be shown."""
    marker = change.marker
    if not _good((*marker.pose, *marker.size, *marker.colour)):
        return None
    found: dict[str, Any] = {
        "frame": change.frame[:100],
        "kind": marker.shape,
        "pose": _round(marker.pose),
        "scale": _round(marker.size),
        "color": _round(marker.colour),
    }
    points, colours = marker.points[:_MOST_POINTS], marker.colours[:_MOST_POINTS, :3]
    if not _good(points):
        return None
    if len(points):
        found["points"] = points.round(4).ravel().tolist()
        if len(colours) == len(points) and _good(colours):
            found["colors"] = colours.round(4).ravel().tolist()
    if marker.shape == "text":
        found["text"] = printable(marker.text[:200])
    return found


def _good(numbers: Sequence[float] | NDArray[np.float64]) -> bool:
    return bool((np.abs(numbers) < _FARTHEST).all())


def _round(numbers: Sequence[float]) -> list[float]:
    return [round(each, 4) for each in numbers]
