"""Fiducials with an ambiguous orientation, which views from several poses resolve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.rigid import Floats, angle_between, invert
from ur_nodes.vision.estimation.observation import CLEAR, Observation, Sighting, choose_sighting, misfit

_KEPT = 12  # views of a fiducial
_SAME = 0.15  # rad by which two guesses at one pose differ
_CERTAIN = 0.1  # rad: standard deviation of the turn, all views together, below which a pose counts as known


@dataclass(frozen=True, slots=True)
class FiducialView:
    """A fiducial seen at a moment of the graph by a robot at an estimated pose (4, 4)."""

    moment: int
    robot: Floats
    observation: Observation


class Unsettled:
    """Views of fiducials that wait for their pose to become clear."""

    def __init__(self) -> None:
        self._views: dict[int, list[FiducialView]] = {}

    def add(self, view: FiducialView) -> Floats | None:
        """Keep a view. Returns the pose (4, 4) in the map once it is unambiguous; then call `take`."""
        views = self._views.setdefault(view.observation.id, [])
        views.append(view)
        del views[:-_KEPT]
        return settle(views)

    def take(self, fiducial: int, pose: Floats) -> list[tuple[int, Sighting]]:
        """Remove and return the moments and sightings of a fiducial whose pose has become unambiguous."""
        chosen = [
            (view.moment, choose_sighting(view.observation, invert(view.robot) @ pose))
            for view in self._views.pop(fiducial)
        ]
        return [(moment, sighting) for moment, sighting in chosen if sighting]


def settle(views: list[FiducialView]) -> Floats | None:
    """Return the pose (4, 4) in the map on which all views agree much better than on any other; None without one."""
    turns = [np.linalg.eigvalsh(s.covariance[:3, :3])[-1] for view in views for s in view.observation.sightings[:1]]
    if sum(1.0 / turn for turn in turns) < 1.0 / _CERTAIN**2:
        return None
    guesses = [view.robot @ sighting.pose for view in views for sighting in view.observation.sightings]
    costs = []
    for guess in guesses:
        expected = [(view, invert(view.robot) @ guess) for view in views]
        costs.append(sum(min(misfit(each, pose) for each in view.observation.sightings) for view, pose in expected))
    best = min(range(len(guesses)), key=lambda index: costs[index])
    others = [cost for guess, cost in zip(guesses, costs, strict=True) if angle_between(guess, guesses[best]) > _SAME]
    return guesses[best] if all(cost - costs[best] > CLEAR for cost in others) else None
