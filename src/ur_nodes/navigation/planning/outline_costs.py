"""Costs of a search for the motion of an outline."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SearchCosts:
    """Costs: of a metre not driven ahead, a change of gear (m), a metre with no room beside it.

    `greed` is the weight of what is left of the way.
    """

    backward: float
    reversal: float
    narrow: float
    greed: float


SPINNING = SearchCosts(2.0, 0.5, 3.0, 1.3)
SHUNTING = SearchCosts(1.3, 0.2, 2.0, 2.5)  # without turns on the spot: the way is longer than the crow flies
