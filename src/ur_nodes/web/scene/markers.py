"""Markers of visualization_msgs as bounded plain values."""

from __future__ import annotations

import math
from typing import Any

from ur.source.printable import printable

ADD, DELETE, DELETE_ALL = 0, 2, 3
"""Actions of a marker."""

_KINDS = {
    0: "arrow",
    1: "cube",
    2: "sphere",
    3: "cylinder",
    4: "line_strip",
    5: "line_list",
    6: "cube_list",
    7: "sphere_list",
    8: "points",
    9: "text",
    11: "triangles",
}
_MOST = 300  # markers of one topic
_MOST_POINTS = 3000  # of one marker
_MOST_POINTS_OF_ALL = 12_000
_FARTHEST = 1e5  # m


class Markers:
    """The markers of one topic by namespace and id. Times are seconds of any steady clock."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, int], tuple[float, dict[str, Any]]] = {}
        self.changed = False

    def take(self, marker: Any, now: float) -> None:
        """Take a message of the type Marker; one that is malformed is left out."""
        key = str(marker.ns)[:200], int(marker.id)
        if marker.action == DELETE_ALL:
            self._known.clear()
        elif marker.action == DELETE:
            self._known.pop(key, None)
        elif marker.action == ADD:
            found = describe_marker(marker)
            if found is None or (key not in self._known and len(self._known) >= _MOST):
                return
            life = marker.lifetime.to_sec()
            self._known[key] = (now + life if life > 0 else math.inf), found
        self.changed = True

    def describe(self, now: float) -> list[dict[str, Any]]:
        """The markers that are shown now, within the bounds of all."""
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
        """Return whether a marker has outlived itself since it was described."""
        return any(until <= now for until, _ in self._known.values())


def describe_marker(marker: Any) -> dict[str, Any] | None:
    """A marker as JSON: frame, kind, pose, scale, colour, points and text; None where it cannot be shown."""
    kind = _KINDS.get(marker.type)
    place, turn = marker.pose.position, marker.pose.orientation
    pose = [place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w]
    scale = [marker.scale.x, marker.scale.y, marker.scale.z]
    colour = [marker.color.r, marker.color.g, marker.color.b, marker.color.a]
    if kind is None or not _good([*pose, *scale, *colour]):
        return None
    found: dict[str, Any] = {
        "frame": str(marker.header.frame_id).lstrip("/")[:100],
        "kind": kind,
        "pose": _round(pose),
        "scale": _round(scale),
        "color": _round(colour),
    }
    points = [number for each in marker.points[:_MOST_POINTS] for number in (each.x, each.y, each.z)]
    if not _good(points):
        return None
    if points:
        found["points"] = _round(points)
        colours = [number for each in marker.colors[:_MOST_POINTS] for number in (each.r, each.g, each.b)]
        if len(colours) == len(points) and _good(colours):
            found["colors"] = _round(colours)
    if kind == "text":
        found["text"] = printable(str(marker.text)[:200])
    return found


def _good(numbers: list[float]) -> bool:
    return all(math.isfinite(each) and abs(each) < _FARTHEST for each in numbers)


def _round(numbers: list[float]) -> list[float]:
    return [round(each, 4) for each in numbers]
