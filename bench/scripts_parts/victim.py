"""A script that drives until it is lost: SIGUSR1 lets its thread hang, SIGUSR2 lets it raise an exception.

ubiquity_launches/lib/node victim.py drive|goal|home
"""

from __future__ import annotations

import signal
import sys
import time

from ur_nodes.client import Robot

HOME = (0.0, 0.0, 0.0)
FAR = (12.1, 7.65)
"""So far away that the robot never arrives."""


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
        if sys.argv[1] == "drive":
            robot.drive(0.15, 0.5, 40.0)
        else:
            robot.go_to(*(FAR if sys.argv[1] == "goal" else HOME))


if __name__ == "__main__":
    main()
