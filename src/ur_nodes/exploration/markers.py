"""Frontiers as markers, as upstream's `explore_lite` shows them: blue ones are left, red ones given up or left out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ur_nodes.exploration.search.floor import Floor
from ur_nodes.exploration.search.frontiers import Frontier
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.values import Marker

_LEFT, _GIVEN_UP = (0.0, 0.0, 1.0, 1.0), (1.0, 0.0, 0.0, 1.0)
_SIZE = (0.1, 0.1, 0.0)


def mark_frontiers(floor: Floor, frontiers: Sequence[Frontier], blocked: Sequence[Frontier]) -> tuple[Marker, ...]:
    """Return all frontiers as points."""
    origin = Pose2(0.0, 0.0, 0.0).in_space()
    coloured = [(each, _LEFT) for each in frontiers] + [(each, _GIVEN_UP) for each in blocked]
    return tuple(
        Marker("frontiers", number, "points", origin, _SIZE, colour, "", _points(floor, each))
        for number, (each, colour) in enumerate(coloured)
    )


def _points(floor: Floor, frontier: Frontier) -> np.ndarray:
    points = floor.points_of_cells(frontier.cells)
    return np.column_stack((points, np.zeros(len(points))))
