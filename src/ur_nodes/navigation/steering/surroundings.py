"""What the robot must not touch: obstacles round it, and people."""

from __future__ import annotations

from dataclasses import dataclass

from ur_nodes.costmap.costmap import Costmap
from ur_nodes.navigation.people.tracked_people import NO_PEOPLE, TrackedPeople


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """Obstacles as cells of a costmap, and people, both in the odometry frame."""

    costmap: Costmap
    people: TrackedPeople = NO_PEOPLE
