"""The fixed goals of each world: x, y in m in the map, heading in degrees.

Drawn once at random: at least 0.32 m from any obstacle, 6 to 20 m of shortest way from one to the next (the first from
the start at the origin), any heading. Then rounded and written down.
"""

from __future__ import annotations

Goal = tuple[float, float, float]

GOALS: dict[str, tuple[Goal, ...]] = {
    "maze": (
        (7.87, 1.53, -140),
        (2.03, 7.62, -160),
        (7.23, 10.63, 160),
        (2.03, 13.83, 40),
        (0.03, 1.68, 0),
        (6.08, 3.08, 60),
        (11.88, 13.83, 170),
        (7.18, 4.18, 10),
        (7.43, 13.38, 30),
        (10.83, 10.18, -100),
    ),
    "office": (
        (5.88, 6.47, 160),
        (8.03, -6.43, -120),
        (10.73, 1.47, -60),
        (14.28, 2.43, -140),
        (14.18, -5.22, 140),
        (8.48, -2.53, 120),
        (8.23, 4.22, 180),
        (13.93, -0.12, 10),
        (9.83, 3.22, -90),
        (12.28, -1.97, -30),
    ),
}

OBSTACLE_GOALS = (1, 4, 7)
"""The goals (from 0) during which an obstacle appears on the way, with --obstacles."""
