"""Corners: frontiers that hide little. They are left to the end, and the least of them are left out."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ur_nodes.exploration.search.viewpoints import Viewpoint

_SAME = 1.0  # m: a frontier so near to the pursued one is the same, after the map has changed
_PURSUED = 0.5  # of the limit: what is pursued becomes a corner later, so that the robot does not turn back and forth
_SOON = 3.0  # m: after a way so long without news what is pursued becomes no corner at all


@dataclass(frozen=True, slots=True)
class CornerSettings:
    """A frontier with less than `area` m2 behind it, or less than `share` of the known floor, is a corner.

    One with `room` m2 is none however large the map is: the gain of a doorway is counted as its width squared at most.
    `left_out`: corners may be left out that hide so much of the known floor together, as a share; 0: none is.
    """

    area: float = 0.3
    share: float = 0.005
    room: float = 0.5
    left_out: float = 0.02


@dataclass(frozen=True, slots=True)
class Viewpoints:
    """Viewpoints by what they can show: `now`, those that are chosen from; `later`, after these; and `left_out`."""

    now: tuple[Viewpoint, ...]
    later: tuple[Viewpoint, ...] = ()
    left_out: tuple[Viewpoint, ...] = ()

    @property
    def ahead(self) -> tuple[Viewpoint, ...]:
        """Return all viewpoints that will be visited."""
        return self.now + self.later


def sort_corners(
    viewpoints: Sequence[Viewpoint],
    known: float,
    settings: CornerSettings,
    kept: tuple[float, float] | None = None,
    idle_distance: float = 0.0,
) -> Viewpoints:
    """Sort viewpoints on a map with `known` m2 of floor; `kept` (m) is the frontier that the robot drives to.

    `idle_distance` (m): how far it has driven since the map last grew.

    `now` is empty if no viewpoint is worth its distance.
    """
    least = max(settings.area, min(settings.share * known, settings.room))

    def worth(each: Viewpoint) -> bool:
        pursued = kept is not None and math.dist(each.frontier.point, kept) < _SAME
        limit = 0.0 if idle_distance > _SOON else _PURSUED * least
        return each.frontier.gain >= (limit if pursued else least)

    rooms = tuple(each for each in viewpoints if worth(each))
    corners = sorted((each for each in viewpoints if not worth(each)), key=lambda each: each.frontier.gain)
    left_out: list[Viewpoint] = []
    hidden = 0.0
    for each in corners:
        hidden += each.frontier.gain
        if hidden > settings.left_out * known:
            break
        left_out.append(each)
    visited = tuple(corners[len(left_out) :])
    return Viewpoints(rooms, visited, tuple(left_out)) if rooms else Viewpoints(visited, (), tuple(left_out))
