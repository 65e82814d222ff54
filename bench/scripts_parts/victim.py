"""A script that drives until it is lost: SIGUSR1 lets its thread hang, SIGUSR2 lets it raise an exception.

ubiquity_launches/lib/node victim.py drive|goal
"""

from __future__ import annotations

import math
import signal
import sys
import time

from ur_nodes.client import Robot

PLACES = ((12.1, 7.65), (0.0, 0.0))
"""So far from one another that the robot never arrives."""


def hang(*_: object) -> None:
    """Never return to what the thread was at."""
    while True:
        time.sleep(3600.0)


def fail(*_: object) -> None:
    """Raise what a script may raise anywhere."""
    raise RuntimeError("a mistake of the script")


def main() -> None:
    """Drive, as the argument says."""
    signal.signal(signal.SIGUSR1, hang)
    signal.signal(signal.SIGUSR2, fail)
    with Robot("victim") as robot:
        here = robot.pose()
        print("drives", flush=True)
        if sys.argv[1] == "drive":
            robot.drive(0.15, 0.5, 40.0)
        else:
            robot.go_to(*max(PLACES, key=lambda place: math.dist(place, (here.x, here.y))))


if __name__ == "__main__":
    main()
