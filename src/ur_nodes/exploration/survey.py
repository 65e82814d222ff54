"""The frontiers of one map: those that a reachable place shows, and the others, each with the reason."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from ur_nodes.exploration.memory import AttemptMemory
from ur_nodes.exploration.reasons import Reason, at, explain_unreachable
from ur_nodes.exploration.search.floor import OCCUPIED_FROM, Floor
from ur_nodes.exploration.search.frontiers import Frontier, find_frontiers
from ur_nodes.exploration.search.viewpoints import DISTANCES, Viewpoint, find_viewpoint, next_viewpoint
from ur_nodes.geometry.grid import Grid

_KEPT_FOR = 10.0  # s: an explanation takes a search of the whole map
_SAME = 0.3  # m: a frontier this near to one that was explained is the same


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """The floor of a map, the places that show its frontiers, and the `blocked` frontiers, each with the reason."""

    floor: Floor
    viewpoints: tuple[Viewpoint, ...]
    blocked: tuple[tuple[Frontier, Reason], ...]


def survey_frontiers(
    floor: Floor, memory: AttemptMemory, explain: Callable[[Frontier], Reason], *, smallest: float, room: float
) -> Survey:
    """Find a viewpoint for each frontier of at least `smallest` m that the memory does not refuse.

    Viewpoints have `room` m around them where they can. `explain` is called for frontiers that nothing leads to.
    """
    viewpoints: list[Viewpoint] = []
    blocked: list[tuple[Frontier, Reason]] = []
    for frontier in find_frontiers(floor, smallest):
        found = _find_view(floor, memory, frontier, explain, room)
        if isinstance(found, Viewpoint):
            viewpoints.append(found)
        else:
            blocked.append((frontier, found))
    return Survey(floor, tuple(viewpoints), tuple(blocked))


def _find_view(
    floor: Floor, memory: AttemptMemory, frontier: Frontier, explain: Callable[[Frontier], Reason], room: float
) -> Viewpoint | Reason:
    refused = memory.refused(frontier)
    if refused is not None:
        return refused
    looks = memory.find(frontier.point).looks
    viewpoint = next_viewpoint(floor, frontier, looks, room)
    if viewpoint is not None:
        return viewpoint
    if looks and find_viewpoint(floor, frontier, DISTANCES[1]) is not None:
        return Reason("unseen", frontier.point, f"at {at(frontier.point)} the lidar sees nothing")
    return explain(frontier)


class Explanations:
    """Explains unreachable frontiers, and keeps each explanation for some seconds."""

    def __init__(self) -> None:
        self._kept: tuple[tuple[float, tuple[float, float], Reason], ...] = ()  # time (s), place (m) of the frontier

    def explain(self, now: float, grid: Grid, floor: Floor, frontier: Frontier) -> Reason:
        """Return the reason why no place that the robot gets to shows a frontier; `floor` is that of `grid`."""
        for explained_at, place, reason in self._kept:
            if math.dist(place, frontier.point) < _SAME and now - explained_at < _KEPT_FOR:
                return reason
        reason = explain_unreachable(floor, frontier, grid.values >= OCCUPIED_FROM)
        recent = (each for each in self._kept if now - each[0] < _KEPT_FOR)
        self._kept = (*recent, (now, frontier.point, reason))
        return reason
