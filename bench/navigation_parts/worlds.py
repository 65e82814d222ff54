"""The fixed goals of each world: x, y in m in the map, heading in degrees.

Drawn once at random: at least 0.32 m from any obstacle, 6 to 20 m of shortest way from one to the next (the first from
the start at the origin), any heading. Then rounded and written down.
"""

from __future__ import annotations

Goal = tuple[float, float, float]

GOALS: dict[str, tuple[Goal, ...]] = {
    "maze": (
        (7.77, -12.12, -140),
        (1.93, -6.03, -160),
        (7.13, -3.02, 160),
        (1.93, 0.18, 40),
        (-0.07, -11.97, 0),
        (5.98, -10.57, 60),
        (11.78, 0.18, 170),
        (7.08, -9.47, 10),
        (7.33, -0.27, 30),
        (10.73, -3.47, -100),
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
